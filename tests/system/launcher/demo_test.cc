#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "system/launcher/demo_run.h"

using conav::testing::DemoRun;
namespace fs = std::filesystem;

namespace {

// What the table holds, without wall times.
nlohmann::json Table(nlohmann::json result) {
  for (auto& robot : result["robots"]) {
    robot.erase("decision_ms_median");
    robot.erase("decision_ms_p99");
  }
  return {result["robots"], result["mapping_accuracy_after"], result["cell_accuracy_after"]};
}

std::vector<std::string> BlindRun(int seed, const std::string& dds) {
  return {"--headless", "--camera", "none", "--seed", std::to_string(seed), "--dds", dds};
}

/// Two map_server files of one small building, a pixel a cell: the plan draws a wall where the
/// building has its eastern door.
class Building {
 public:
  Building() {
    std::string pattern = (fs::temp_directory_path() / "conav-building-XXXXXX").string();
    REQUIRE(mkdtemp(pattern.data()) != nullptr);
    folder_ = pattern;
    Write("truth", {"#########", "#       #", "# ##### #", "#       #", "### ### #", "#       #",
                    "#########"});
    Write("plan", {"#########", "#       #", "# ##### #", "#       #", "### #####", "#       #",
                   "#########"});
  }
  ~Building() { fs::remove_all(folder_); }

  std::string map() const { return (folder_ / "truth.yaml").string(); }
  std::string outdated_plan() const { return (folder_ / "plan.yaml").string(); }

 private:
  void Write(const std::string& name, const std::vector<std::string>& rows) const {
    std::ofstream image(folder_ / (name + ".pgm"));
    image << "P2\n" << rows[0].size() << " " << rows.size() << "\n255\n";
    for (const std::string& row : rows) {
      for (const char cell : row) image << (cell == '#' ? "0 " : "254 ");
      image << "\n";
    }
    std::ofstream(folder_ / (name + ".yaml"))
        << "image: " << name << ".pgm\nresolution: 2.0\norigin: [0, 0, 0]\nnegate: 0\n"
        << "occupied_thresh: 0.65\nfree_thresh: 0.196\n";
  }

  fs::path folder_;
};

void ReachesAllGoals(const std::vector<std::string>& arguments) {
  CAPTURE(arguments);
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

// 20 seeds, each on one of the three choices.
TEST_CASE("a robot reaches all goals on Cyclone DDS whatever the seed", "[launcher][system]") {
  const int seed = GENERATE(1, 4, 7, 10, 13, 16, 19);
  ReachesAllGoals(BlindRun(seed, "cyclonedds"));
}

TEST_CASE("a robot reaches all goals on Fast DDS whatever the seed", "[launcher][system]") {
  const int seed = GENERATE(2, 5, 8, 11, 14, 17, 20);
  ReachesAllGoals(BlindRun(seed, "fastdds"));
}

TEST_CASE("a robot reaches all goals with both vendors mixed whatever the seed",
          "[launcher][system]") {
  const int seed = GENERATE(3, 6, 9, 12, 15, 18);
  ReachesAllGoals(BlindRun(seed, "mixed"));
}

TEST_CASE("four robots in one world reach all goals", "[launcher][system]") {
  const std::string dds = GENERATE("cyclonedds", "fastdds", "mixed");
  ReachesAllGoals({"--headless", "--seed", "4", "--robots", "4", "--dds", dds});
}

TEST_CASE("two robots share the goals of a building whose plan is outdated", "[launcher][system]") {
  const Building building;
  DemoRun demo({"--headless", "--camera", "none", "--robots", "2", "--shared-goals", "--map",
                building.map(), "--operator-map", building.outdated_plan()});
  const int code = demo.Wait();
  INFO(demo.Story());
  CHECK(code == 0);
  const nlohmann::json result = demo.Json();
  REQUIRE(result.is_object());
  CHECK(result["all_goals_reached"] == true);
  CHECK(result["map"] == building.map());
  CHECK(result["cell_accuracy_before"] < 1.0);
  int reached = 0;
  for (const auto& robot : result["robots"]) reached += robot["goals_reached"].get<int>();
  CHECK(result["robots"].size() == 2);
  CHECK(reached == result["robots"][0]["goals_total"]);
}

TEST_CASE("a planner that estimates the operator's map reaches all goals", "[launcher][system]") {
  ReachesAllGoals({"--headless", "--seed", "10", "--camera", "none", "--x-source", "estimated"});
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

TEST_CASE("teleoperation streams a picture for each low-level step and repeats itself",
          "[launcher][system]") {
  const std::vector<std::string> arguments{"--headless", "--seed", "9",     "--method", "teleop",
                                           "--camera",   "none",   "--dds", "mixed"};
  DemoRun first(arguments);
  REQUIRE(first.Wait() == 0);
  DemoRun second(arguments);
  REQUIRE(second.Wait() == 0);
  const nlohmann::json robot = first.Json()["robots"][0];
  CHECK(robot["pictures"] == robot["low_level_steps"]);
  CHECK(robot["decisions"] <= robot["low_level_steps"]);
  CHECK(robot["guidance"] == 0);
  CHECK(Table(first.Json()) == Table(second.Json()));
}

TEST_CASE("teleoperation reaches all goals by rendered pictures", "[launcher][system]") {
  ReachesAllGoals({"--headless", "--seed", "3", "--method", "teleop"});
}

TEST_CASE("four robots under teleoperation reach all goals", "[launcher][system]") {
  ReachesAllGoals(
      {"--headless", "--seed", "5", "--robots", "4", "--method", "teleop", "--camera", "none"});
}

TEST_CASE("greedy robots reach all goals without pictures", "[launcher][system]") {
  const std::string robots = GENERATE("1", "4");
  const std::string seed = GENERATE("3", "12");
  DemoRun demo(
      {"--headless", "--seed", seed, "--robots", robots, "--method", "greedy", "--camera", "none"});
  const int code = demo.Wait();
  INFO(demo.Story());
  CHECK(code == 0);
  const nlohmann::json result = demo.Json();
  CHECK(result["all_goals_reached"] == true);
  for (const auto& robot : result["robots"]) CHECK(robot["pictures"] == 0);
}

TEST_CASE("a rule sends the pictures in the place of the search", "[launcher][system]") {
  const std::string policy = GENERATE("never", "random", "every", "when_blocked", "threshold");
  DemoRun demo({"--headless", "--seed", "7", "--communication", policy, "--camera", "none"});
  const int code = demo.Wait();
  INFO(demo.Story());
  CHECK(code == 0);
  const nlohmann::json result = demo.Json();
  CHECK(result["communication"] == policy);
  if (policy == "never") CHECK(result["robots"][0]["pictures"] == 0);
  if (policy == "every") CHECK(result["robots"][0]["pictures"] > 0);
}

TEST_CASE("the same seed gives the same table twice", "[launcher][system]") {
  const std::vector<std::string> arguments{"--headless", "--seed", "8"};
  DemoRun first(arguments);
  REQUIRE(first.Wait() == 0);
  DemoRun second(arguments);
  REQUIRE(second.Wait() == 0);
  CHECK(Table(first.Json()) == Table(second.Json()));
}

TEST_CASE("the same seed gives the same table with the model in the planner and as a service",
          "[launcher][system]") {
  const auto played = [](const std::string& perception) {
    DemoRun demo({"--headless", "--camera", "none", "--seed", "8", "--perception", perception});
    const int code = demo.Wait();
    INFO(demo.Story());
    REQUIRE(code == 0);
    return Table(demo.Json());
  };
  CHECK(played("embedded") == played("remote"));
}

TEST_CASE("a run leaves configuration, logs, metrics and a picture", "[launcher][system]") {
  DemoRun demo({"--headless", "--seed", "9", "--camera", "none"});
  const int code = demo.Wait();
  INFO(demo.Story());
  REQUIRE(code == 0);
  const std::filesystem::path run = demo.RunFolder();
  for (const char* service :
       {"recorder", "sim", "nhpm", "operator", "planner", "simulated-operator"}) {
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
