#include "launcher/run_folder.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "common/runtime/file.h"
#include "support/temporary_folder.h"

using conav::launcher::RunFolder;
namespace test = conav::test;
namespace fs = std::filesystem;

namespace {

const std::chrono::system_clock::time_point kTime{std::chrono::seconds(1'700'000'000)};

}  // namespace

TEST_CASE("a run folder has room for configuration, logs and state", "[launcher]") {
  const test::TemporaryFolder temporary;
  const RunFolder run(temporary / "runs", kTime, 7);
  CHECK(fs::is_directory(run.path() / "config"));
  CHECK(fs::is_directory(run.state()));
  CHECK(run.log("sim-w1") == run.path() / "logs" / "sim-w1.log");
  run.Write(run.config("sim-w1"), "sim: {}\n");
  CHECK(fs::file_size(run.config("sim-w1")) == 8);
  // Two runs of the same second and seed.
  CHECK(run.path().filename() == "20231114-221320-seed7");
  CHECK(RunFolder(temporary / "runs", kTime, 7).path().filename() == "20231114-221320-seed7-2");
}

TEST_CASE("a run folder that cannot be made is refused with its path", "[launcher]") {
  CHECK_THROWS_WITH(RunFolder("/proc/self/status/runs", kTime, 7),
                    Catch::Contains("/proc/self/status/runs"));
}

TEST_CASE("a log that is too large goes on from its start, and keeps what was before",
          "[launcher]") {
  const test::TemporaryFolder folder;
  const auto log = folder / "sim.log";
  std::ofstream process(log, std::ios::app);
  process << "one\n" << std::flush;
  conav::launcher::LimitLog(log, 4);
  CHECK(conav::ReadFile(log) == "one\n");
  process << "two\n" << std::flush;
  conav::launcher::LimitLog(log, 4);
  process << "three\n" << std::flush;
  CHECK(conav::ReadFile(log) == "three\n");
  CHECK(conav::ReadFile(folder / "sim.log.1") == "one\ntwo\n");
}
