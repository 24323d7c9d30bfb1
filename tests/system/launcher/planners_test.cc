// Several planner processes that share the robots of a demo.
#include <signal.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <regex>

#include "launcher/process.h"
#include "system/launcher/demo_run.h"

using conav::testing::DemoRun;
using conav::testing::WaitUntil;
using namespace std::chrono_literals;

namespace {

/// Slow enough that something can be done to it before it ends.
std::vector<std::string> SharedRun(const std::string& dds, const std::string& planners) {
  return {"--headless", "--speed", "10",    "--camera", "none",       "--seed", "7",
          "--robots",   "4",       "--dds", dds,        "--planners", planners};
}

bool Says(const DemoRun& demo, const std::string& text) {
  return WaitUntil([&] { return demo.Output().find(text) != std::string::npos; }, 60s);
}

/// Each robot is driven by one of two planners before something is done to them.
void WaitUntilShared(DemoRun& demo) {
  for (const char* planner : {"planner-1 drives r", "planner-2 drives r"}) {
    INFO(demo.Story());
    REQUIRE(Says(demo, planner));
  }
  REQUIRE(demo.WaitForMoves());
}

void EndsWell(DemoRun& demo) {
  const int code = demo.Wait();
  INFO(demo.Story());
  CHECK(code == 0);
  CHECK(demo.Json()["all_goals_reached"] == true);
  for (const auto& robot : demo.Json()["robots"]) {
    CHECK(robot["goals_reached"] == robot["goals_total"]);
    CHECK(robot["decisions"] >= robot["cell_moves"]);
  }
}

int Count(const std::string& text, const std::string& what) {
  int count = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

}  // namespace

TEST_CASE("two planners share the robots and all reach their goals", "[launcher][system]") {
  const std::string dds = GENERATE("cyclonedds", "fastdds", "mixed");
  CAPTURE(dds);
  DemoRun demo({"--headless", "--camera", "none", "--seed", "3", "--robots", "4", "--dds", dds,
                "--planners", "2"});
  EndsWell(demo);
  CHECK_THAT(demo.Output(), Catch::Contains("planner-1 drives r") &&
                                Catch::Contains("planner-2 drives r") &&
                                !Catch::Contains("took over"));
}

TEST_CASE("the other planner takes over when one is killed", "[launcher][system]") {
  const std::string dds = GENERATE("cyclonedds", "fastdds", "mixed");
  CAPTURE(dds);
  DemoRun demo(SharedRun(dds, "2"));
  const pid_t victim = demo.PidOf("planner-2");
  WaitUntilShared(demo);
  REQUIRE(kill(victim, SIGKILL) == 0);
  EndsWell(demo);
  CHECK_THAT(demo.Output(),
             Catch::Contains("planner-2 (pid " + std::to_string(victim) + ") died: signal 9") &&
                 Catch::Contains("planner-1 took over r") && Catch::Contains("from planner-2"));
}

TEST_CASE("the demo ends when the last of two planners dies", "[launcher][system]") {
  DemoRun demo(SharedRun("cyclonedds", "2"));
  const pid_t first = demo.PidOf("planner-1");
  const pid_t second = demo.PidOf("planner-2");
  WaitUntilShared(demo);
  REQUIRE(kill(first, SIGKILL) == 0);
  REQUIRE(kill(second, SIGKILL) == 0);
  CHECK(demo.Wait(60s) == 1);
  INFO(demo.Story());
  CHECK_THAT(demo.Output(),
             Catch::Contains("died: signal 9") && Catch::Contains("stopped in cell"));
}

TEST_CASE("a planner that hung learns that it lost its robots, and does not fight for them",
          "[launcher][system]") {
  const std::string dds = GENERATE("cyclonedds", "fastdds", "mixed");
  CAPTURE(dds);
  DemoRun demo(SharedRun(dds, "2"));
  const pid_t victim = demo.PidOf("planner-1");
  WaitUntilShared(demo);
  REQUIRE(kill(victim, SIGSTOP) == 0);
  const bool taken_over = Says(demo, "planner-2 took over r");
  REQUIRE(kill(victim, SIGCONT) == 0);
  INFO(demo.Story());
  CHECK(taken_over);
  EndsWell(demo);
  // Its share comes back once, by handing over, at most.
  CHECK(Count(demo.Output(), "planner-1 took over") <= 2);
  CHECK(Count(demo.Output(), "planner-2 took over") <= 2);
}

TEST_CASE("a planner that is started by hand in the middle gets its share", "[launcher][system]") {
  DemoRun demo(SharedRun("cyclonedds", "1"));
  demo.PidOf("planner");
  REQUIRE(demo.WaitForMoves());
  // The demo's own configuration under another name, with a record of its own.
  const auto config = demo.RunFolder() / "config" / "planner-late.yaml";
  std::ifstream original(demo.RunFolder() / "config" / "planner.yaml");
  std::string text{std::istreambuf_iterator<char>(original), {}};
  text = std::regex_replace(text, std::regex("name: planner\\b"), "name: planner-late");
  text = std::regex_replace(text, std::regex("decisions\\.pb"), "decisions-planner-late.pb");
  std::ofstream(config) << text;
  conav::launcher::Process late(
      "planner-late", {std::string(CONAV_BIN_DIR) + "/conav-planner", "--config", config.string()},
      demo.RunFolder() / "logs" / "planner-late.log");
  CHECK(Says(demo, "planner-late took over r"));
  // And when it leaves, the demo's own planner goes on at once.
  late.Signal(SIGTERM);
  CHECK(WaitUntil([&] { return late.Poll(); }, 20s));
  EndsWell(demo);
  CHECK_THAT(demo.Output(),
             Catch::Contains("planner took over r") && Catch::Contains("from planner-late"));
}
