#include <catch2/catch.hpp>
#include <filesystem>

#include "system/launcher/demo_run.h"

using conav::testing::DemoRun;

namespace {

// What the table holds, without wall times.
nlohmann::json Table(nlohmann::json result) {
  for (auto& robot : result["robots"]) {
    robot.erase("decision_ms_median");
    robot.erase("decision_ms_p99");
  }
  return {result["robots"], result["mapping_accuracy_after"], result["cell_accuracy_after"]};
}

void ReachesAllGoals(const std::vector<std::string>& arguments) {
  DemoRun demo(arguments);
  const int code = demo.Wait();
  INFO(demo.Story());
  CHECK(code == 0);
  const nlohmann::json result = demo.Json();
  REQUIRE(result.is_object());
  CHECK(result["all_goals_reached"] == true);
  for (const auto& robot : result["robots"]) {
    CHECK(robot["goals_total"] > 0);
    CHECK(robot["cell_moves"] > 0);
    CHECK(robot["decisions"] >= robot["cell_moves"]);
  }
}

}  // namespace

TEST_CASE("a demo reaches all goals on Cyclone DDS", "[launcher][system]") {
  ReachesAllGoals({"--headless", "--seed", "1", "--dds", "cyclonedds"});
}

TEST_CASE("a demo reaches all goals on Fast DDS", "[launcher][system]") {
  ReachesAllGoals({"--headless", "--seed", "2", "--dds", "fastdds"});
}

TEST_CASE("a demo reaches all goals with both vendors mixed", "[launcher][system]") {
  ReachesAllGoals({"--headless", "--seed", "3", "--dds", "mixed"});
}

TEST_CASE("four robots in one world reach all goals", "[launcher][system]") {
  ReachesAllGoals({"--headless", "--seed", "4", "--robots", "4"});
}

TEST_CASE("two worlds run beside each other", "[launcher][system]") {
  ReachesAllGoals({"--headless", "--seed", "5", "--worlds", "2", "--camera", "none"});
}

TEST_CASE("instruction following reaches all goals", "[launcher][system]") {
  ReachesAllGoals({"--headless", "--seed", "6", "--method", "instruction", "--camera", "none"});
}

TEST_CASE("teleoperation reaches all goals", "[launcher][system]") {
  ReachesAllGoals({"--headless", "--seed", "7", "--method", "teleop", "--camera", "none"});
}

TEST_CASE("the same seed gives the same table twice", "[launcher][system]") {
  const std::vector<std::string> arguments{"--headless", "--seed", "8"};
  DemoRun first(arguments);
  REQUIRE(first.Wait() == 0);
  DemoRun second(arguments);
  REQUIRE(second.Wait() == 0);
  CHECK(Table(first.Json()) == Table(second.Json()));
}

TEST_CASE("a run leaves configuration, logs, metrics and a picture", "[launcher][system]") {
  DemoRun demo({"--headless", "--seed", "9", "--camera", "none"});
  const int code = demo.Wait();
  INFO(demo.Story());
  REQUIRE(code == 0);
  const std::filesystem::path run = demo.RunFolder();
  for (const char* service : {"sim", "nhpm", "operator", "planner", "simulated-operator"}) {
    CHECK(std::filesystem::file_size(run / "config" / (std::string(service) + ".yaml")) > 0);
    CHECK(std::filesystem::file_size(run / "logs" / (std::string(service) + ".log")) > 0);
  }
  CHECK(std::filesystem::file_size(run / "metrics.json") > 0);
  CHECK(std::filesystem::file_size(run / "episode.svg") > 10'000);
  const nlohmann::json result = demo.Json();
  CHECK(result["seed"] == 9);
  CHECK(result["method"] == "ig-mcts");
  CHECK(result["worlds"] == 1);
  CHECK(result["mapping_accuracy_before"] == 0.0);
  CHECK(result["wall_s"] > 0.0);
}
