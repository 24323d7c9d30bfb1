#include "launcher/run_folder.h"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>

#include "common/runtime/result.h"

using conav::launcher::RunFolder;
using conav::launcher::RunId;
namespace fs = std::filesystem;

namespace {

const std::chrono::system_clock::time_point kTime{std::chrono::seconds(1'700'000'000)};

struct TemporaryFolder {
  fs::path path = fs::temp_directory_path() / ("conav_run_folder_" + std::to_string(getpid()));
  ~TemporaryFolder() { fs::remove_all(path); }
};

}  // namespace

TEST_CASE("a run is named by its time and seed", "[launcher][run_folder]") {
  CHECK(RunId(kTime, 7) == "20231114-221320-seed7");
}

TEST_CASE("a run folder has room for configuration, logs and state", "[launcher][run_folder]") {
  const TemporaryFolder temporary;
  const RunFolder run(temporary.path / "runs", kTime, 7);
  CHECK(fs::is_directory(run.path() / "config"));
  CHECK(fs::is_directory(run.state()));
  CHECK(run.log("sim-w1") == run.path() / "logs" / "sim-w1.log");
  run.Write(run.config("sim-w1"), "sim: {}\n");
  CHECK(fs::file_size(run.config("sim-w1")) == 8);
}

TEST_CASE("two runs of the same second get two folders", "[launcher][run_folder]") {
  const TemporaryFolder temporary;
  const RunFolder first(temporary.path, kTime, 7);
  const RunFolder second(temporary.path, kTime, 7);
  CHECK(first.path() != second.path());
  CHECK(second.path().filename() == "20231114-221320-seed7-2");
}

TEST_CASE("a run folder that cannot be made is refused with its path", "[launcher][run_folder]") {
  CHECK_THROWS_WITH(RunFolder("/proc/self/status/runs", kTime, 7),
                    Catch::Contains("/proc/self/status/runs"));
}
