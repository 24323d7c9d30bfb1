// Several planner processes that share the robots of a demo.
#include <signal.h>

#include <catch2/catch.hpp>
#include <regex>

#include "support/text.h"
#include "system/launcher/demo_run.h"

namespace conav::testing {
namespace {

using namespace std::chrono_literals;
using test::CountOf;

/// Slow enough that something can be done to it before it ends.
std::string SharedRun(const std::string& dds, int planners) {
  return fmt::format(
      "--headless --speed 10 --camera none --seed 7 --robots 4 --dds {} --planners {}", dds,
      planners);
}

/// Each robot is driven by one of two planners, and shows it, before something is done to them.
void WaitUntilShared(DemoRun& demo) {
  for (const char* planner : {"planner-1 drives r", "planner-2 drives r"}) {
    INFO(demo.Story());
    REQUIRE(demo.Prints(planner));
  }
  for (const char* robot : {"r1", "r2", "r3", "r4"}) demo.WaitForMoves(robot);
}

}  // namespace

TEST_CASE("a killed planner's robots are driven on, by the other or by itself once it is back",
          "[demo]") {
  const std::string dds = GENERATE("cyclonedds", "fastdds", "mixed");
  CAPTURE(dds);
  DemoRun demo(SharedRun(dds, 2));
  const pid_t victim = demo.PidOf("planner-2");
  WaitUntilShared(demo);
  REQUIRE(kill(victim, SIGKILL) == 0);
  demo.ReachesAllGoals();
  CHECK_THAT(demo.Output(),
             Catch::Contains("planner-2 (pid " + std::to_string(victim) + ") died: signal 9") &&
                 Catch::Contains("restarted planner-2") && Catch::Contains(" took over r") &&
                 Catch::Contains("from planner-2"));
}

TEST_CASE("planners that all die come back and go on", "[demo]") {
  DemoRun demo(SharedRun("cyclonedds", 2));
  const pid_t first = demo.PidOf("planner-1");
  const pid_t second = demo.PidOf("planner-2");
  WaitUntilShared(demo);
  REQUIRE(kill(first, SIGKILL) == 0);
  REQUIRE(kill(second, SIGKILL) == 0);
  CHECK(demo.ReachesAllGoals()["restarts"] == nlohmann::json{{"planner-1", 1}, {"planner-2", 1}});
}

TEST_CASE("a planner that hung learns that it lost its robots, and does not fight for them",
          "[demo]") {
  const std::string dds = GENERATE("cyclonedds", "fastdds", "mixed");
  CAPTURE(dds);
  DemoRun demo(SharedRun(dds, 2));
  const pid_t victim = demo.PidOf("planner-1");
  WaitUntilShared(demo);
  REQUIRE(kill(victim, SIGSTOP) == 0);
  const bool taken_over = demo.Prints("planner-2 took over r");
  REQUIRE(kill(victim, SIGCONT) == 0);
  INFO(demo.Story());
  CHECK(taken_over);
  demo.ReachesAllGoals();
  // Its share comes back once, by handing over, at most.
  CHECK(CountOf(demo.Output(), "planner-1 took over") <= 2);
  CHECK(CountOf(demo.Output(), "planner-2 took over") <= 2);
}

TEST_CASE("a planner that is started by hand in the middle gets its share", "[demo]") {
  const std::string dds = GENERATE("cyclonedds", "fastdds", "mixed");
  CAPTURE(dds);
  DemoRun demo(SharedRun(dds, 1));
  demo.PidOf("planner");
  demo.WaitForMoves();
  // The demo's own configuration under another name, with a record of its own.
  const auto config = demo.RunFolder() / "config" / "planner-late.yaml";
  std::string text = ReadFile(demo.RunFolder() / "config" / "planner.yaml").value();
  text = std::regex_replace(text, std::regex("name: planner\\b"), "name: planner-late");
  text = std::regex_replace(text, std::regex("decisions\\.pb"), "decisions-planner-late.pb");
  REQUIRE(WriteFile(config, text));
  test::RunningProgram late("conav-planner", "--config " + config.string(),
                            demo.RunFolder() / "logs" / "planner-late.log");
  CHECK(demo.Prints("planner-late took over r"));
  // And when it leaves, the demo's own planner goes on at once.
  late.Signal(SIGTERM);
  CHECK(late.Ends(20s));
  demo.ReachesAllGoals();
  CHECK_THAT(demo.Output(),
             Catch::Contains("planner took over r") && Catch::Contains("from planner-late"));
}

}  // namespace conav::testing
