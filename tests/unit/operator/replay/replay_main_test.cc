#include <catch2/catch.hpp>

#include "common/msg/convert.h"
#include "common/runtime/file.h"
#include "support/program_runner.h"
#include "support/taken_port.h"
#include "unit/common/msg/samples.h"
#include "unit/operator/replay/recorded_file.h"

namespace conav::operators {
namespace {

TEST_CASE("conav replay names what is wrong", "[operator][replay]") {
  const test::ProgramRunner folder("conav-replay");
  std::filesystem::create_directory(folder / "run");
  std::filesystem::create_directory(folder / "web");
  REQUIRE(WriteFile(folder / "web/index.html", "<page>"));
  RecordedFile file(folder / "run/recording.mcap");
  file.Write(bus::kRobotGoals, "r1", 1.0, ToMessage(samples::SampleGoals()));
  file.Write(bus::kRobotState, "r1", 1.0, ToMessage(samples::SampleState()));
  file.Finish();
  const std::filesystem::path cut = folder / "cut.mcap";
  std::filesystem::copy_file(folder / "run/recording.mcap", cut);
  std::filesystem::resize_file(cut, std::filesystem::file_size(cut) - 1);
  const test::TakenPort taken;
  struct Row {
    std::string arguments;
    int exit_code;
    std::string names;
  };
  for (const Row& row : std::vector<Row>{
           {"nowhere", 2, "nowhere: "},
           {"web", 1, "web: no recording.mcap"},
           {"web/index.html", 1, "index.html: no MCAP file"},
           {"cut.mcap --port 0 --web run", 1, "warning: cut.mcap: the file was not finished"},
           {"run --port 0 --web run", 1, "index.html"},
           {"run --port 0 --web web >/dev/full", 1, ""},
           {fmt::format("run --web web --port {}", taken.port), 1, std::to_string(taken.port)},
           {"", 2, "run"},
           {"run --colour red", 2, "--colour"},
           {"run --port 99999", 2, "--port"},
           {"run --url-file run/recording.mcap", 2, "--url-file"},
           {"run --url-file no/url", 2, "--url-file"},
           {"--help", 0, ""},
       }) {
    CAPTURE(row.arguments);
    const auto outcome = folder.Run(row.arguments);
    CHECK(outcome.exit_code == row.exit_code);
    CHECK_THAT(outcome.error, Catch::Contains(row.names));
  }
}

}  // namespace
}  // namespace conav::operators
