#include <catch2/catch.hpp>

#include "common/msg/convert.h"
#include "common/runtime/file.h"
#include "support/program_runner.h"
#include "support/taken_port.h"
#include "unit/common/msg/samples.h"
#include "unit/operator/replay/recorded_file.h"

namespace conav::operators {
namespace {

/// A run folder "run", and a page.
struct ReplayFixture : test::ProgramRunner {
  ReplayFixture() : ProgramRunner("conav-replay") {
    std::filesystem::create_directory(*this / "run");
    std::filesystem::create_directory(*this / "web");
    REQUIRE(WriteFile(*this / "web/index.html", "<page>"));
    RecordedFile file(*this / "run/recording.mcap");
    file.Write(bus::kRobotState, "r1", 1.0, ToMessage(samples::SampleState()));
    file.Finish();
  }
};

TEST_CASE("conav replay names what is wrong", "[operator][replay]") {
  const ReplayFixture desk;
  const auto none = desk.Run("nowhere");
  CHECK(none.exit_code == 1);
  CHECK_THAT(none.error, Catch::Contains("conav replay: nowhere: No such file"));
  const auto no_recording = desk.Run("web");
  CHECK(no_recording.exit_code == 1);
  CHECK_THAT(no_recording.error, Catch::Contains("web: no recording.mcap in it"));
  const auto text = desk.Run("web/index.html");
  CHECK(text.exit_code == 1);
  CHECK_THAT(text.error, Catch::Contains("no MCAP file"));
  const auto no_page = desk.Run("run --port 0 --web run");
  CHECK(no_page.exit_code == 1);
  CHECK_THAT(no_page.error, Catch::Contains("index.html"));
  CHECK(desk.Run("run --port 0 --web web >/dev/full").exit_code == 1);
}

TEST_CASE("conav replay says that its port is taken", "[operator][replay]") {
  const ReplayFixture desk;
  const test::TakenPort taken;
  const auto outcome = desk.Run(fmt::format("run --web web --port {}", taken.port));
  CHECK(outcome.exit_code == 1);
  CHECK_THAT(outcome.error,
             Catch::Contains(std::to_string(taken.port)) && Catch::Contains("already in use"));
}

TEST_CASE("conav replay refuses wrong use", "[operator][replay]") {
  const ReplayFixture desk;
  CHECK(desk.Run("").exit_code == 2);
  CHECK(desk.Run("run --colour red").exit_code == 2);
  CHECK(desk.Run("run --port 99999").exit_code == 2);
  CHECK(desk.Run("run --url-file run/recording.mcap").exit_code == 2);
  CHECK(desk.Run("run --url-file no/url").exit_code == 2);
  CHECK(desk.Run("--help").exit_code == 0);
}

}  // namespace
}  // namespace conav::operators
