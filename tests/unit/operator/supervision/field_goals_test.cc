#include "operator/supervision/field_goals.h"

#include <catch2/catch.hpp>

#include "support/temporary_folder.h"

namespace conav::operators {
namespace {

using test::TemporaryFolder;

const std::map<std::string, std::string> kFieldRobots{{"r1", "w1"}, {"r2", "w1"}};

/// A robot in the middle of 5 x 5 cells of 1 m around (10, 20).
RobotState FieldState(std::int64_t stamp, Position position = {10.0, 20.0}) {
  RobotState state{.stamp = {stamp}, .world = "w1", .robot = "r1"};
  state.grid = {5, 5, 1.0, {10.0, 20.0}};
  state.position = position;
  state.cell = state.grid.PositionToCell(position);
  return state;
}

FieldGoals Goals(const Mission& mission = {}, const std::map<std::string, KeptGoals>& stored = {}) {
  return {kFieldRobots, {.tolerance_m = 0.3}, mission, stored};
}

TEST_CASE("a mission file gives robots their goals", "[operator][goals]") {
  const TemporaryFolder folder;
  const auto file = folder.Write("mission.yaml", "r1: [[1, 2.5], [-3, 4]]\nr2:\n  - [5, 6]\n");
  CHECK(ReadMission(file, {"r1", "r2"}) ==
        Mission{{"r1", {{1.0, 2.5}, {-3.0, 4.0}}}, {"r2", {{5.0, 6.0}}}});
  CHECK(ReadMission(folder.Write("empty.yaml", ""), {}) == Mission{});
}

TEST_CASE("a mission that cannot be used is refused with its line", "[operator][goals]") {
  struct Row {
    std::string text;
    std::string line;
    std::string says;
  };
  const TemporaryFolder folder;
  for (const Row& row : std::vector<Row>{{"r1: [[1, 2]]\nr9: [[1, 2]]\n", ":2:", "r9"},
                                         {"r1:\n  - [1, 2]\n  - [1]\n", ":3:", "[1]"},
                                         {"r1:\n  - [1, x]\n", ":2:", "x"},
                                         {"r1: 5\n", ":1:", "r1"},
                                         {"r1: [[1, 2e9]]\n", ":1:", "2000000000"},
                                         {"- [1, 2]\n", ":1:", "robot"},
                                         {"r1: [[1, 2]\nr2: 3\n", "line 2", ""},
                                         {"r1: [[1, 2]]\nr1: [[1, 2]]\n", ":2:", "r1"}}) {
    CAPTURE(row.text);
    const auto mission = ReadMission(folder.Write("m.yaml", row.text), {"r1"});
    REQUIRE_FALSE(mission);
    CHECK(mission.error().code == ErrorCode::kMalformed);
    CHECK_THAT(mission.error().text, Catch::Contains("m.yaml") && Catch::Contains(row.says));
    if (!row.line.empty()) CHECK_THAT(mission.error().text, Catch::Contains(row.line));
  }
  CHECK(ReadMission(folder / "none.yaml", {}).error().code == ErrorCode::kNotFound);
}

TEST_CASE("goals to be found count before they are given", "[operator][goals]") {
  FieldGoals goals({{"r1", "w1"}}, {.to_find = 2}, {}, {});
  const auto first = goals.Receive(FieldState(1));
  REQUIRE(first);
  CHECK(first->goals.total == 2);
  CHECK(first->goals.left.empty());
  goals.Adopt(*goals.Change({"r1", {{10.0, 20.0}}, {}}));
  const auto reached = goals.Receive(FieldState(2));
  REQUIRE(reached);
  CHECK(reached->goals.reached.size() == 1);
  CHECK(reached->goals.total == 2);
}

TEST_CASE("goals are known from the robot's first report, and reached near them or in their cell",
          "[operator][goals]") {
  FieldGoals goals = Goals({{"r1", {{11.4, 20.0}, {10.0, 21.0}, {8.2, 18.2}}}});
  auto kept = goals.Receive(FieldState(100));
  REQUIRE(kept);
  CHECK(kept->goals.stamp == SimTime{100});
  CHECK(kept->goals.left.size() == 3);
  CHECK(kept->goals.total == 3);
  CHECK(kept->goals.tolerance_m == 0.3);
  CHECK_FALSE(goals.Receive(FieldState(200)));
  kept = goals.Receive(FieldState(300, {10.7, 20.2}));  // in the cell, 0.7 m away
  REQUIRE(kept);
  CHECK(kept->goals.reached == std::vector<Position>{{11.4, 20.0}});
  CHECK(kept->goals.stamp == SimTime{300});
  RobotState passing = FieldState(400, {10.0, 20.75});
  passing.cell = {2, 2};  // not there yet, but within 0.3 m
  CHECK(goals.Receive(passing)->goals.left == std::vector<Position>{{8.2, 18.2}});
  CHECK(goals.Receive(passing) == std::nullopt);
}

TEST_CASE("requests add and remove goals, one in a cell, with stamps that rise",
          "[operator][goals]") {
  FieldGoals goals = Goals();
  CHECK_THAT(goals.Change({"r1", {{10.0, 20.0}}, {}}).error().text, Catch::Contains("reported"));
  goals.Receive(FieldState(100));
  const auto adopt = [&](const GoalsRequest& request) {
    const auto kept = goals.Change(request);
    REQUIRE(kept);
    goals.Adopt(*kept);
    return kept->goals;
  };
  CHECK(adopt({"r1", {{11.0, 20.0}, {11.1, 20.1}, {9.0, 20.0}}, {}}).left.size() == 2);
  const RobotGoals fewer = adopt({"r1", {{10.0, 22.0}}, {{10.9, 19.9}}});
  CHECK(fewer.left == std::vector<Position>{{9.0, 20.0}, {10.0, 22.0}});
  CHECK(fewer.stamp == SimTime{102});
  goals.Receive(FieldState(500, {9.0, 20.0}));
  const RobotGoals again = adopt({"r1", {{9.0, 20.0}}, {}});
  CHECK(again.left.size() == 2);
  CHECK(again.reached.empty());
  CHECK(again.total == 2);
  CHECK(again.stamp == SimTime{501});
}

TEST_CASE("requests that cannot be carried out are refused by name", "[operator][goals]") {
  FieldGoals goals = Goals();
  goals.Receive(FieldState(100));
  RobotState own = FieldState(100);
  own.robot = "r2";
  own.goals_stamp = {7};
  CHECK_FALSE(goals.Receive(own));
  CHECK(goals.robots().at("r2").keeps_goals);
  std::vector<Position> many;
  CHECK_THAT(goals.Change({"r9", {{1, 1}}, {}}).error().text, Catch::Contains("r9"));
  CHECK_THAT(goals.Change({"r2", {{10, 20}}, {}}).error().text, Catch::Contains("r2 keeps"));
  CHECK_THAT(goals.Change({"r1", {{0, 0}}, {}}).error().text,
             Catch::Contains("(0, 0)") && Catch::Contains("5x5 cells"));
  CHECK(goals.Change({"r1", {}, {{10, 20}}}).error().code == ErrorCode::kNotFound);
}

TEST_CASE("goals outside of the robot's map are left out, and said so", "[operator][goals]") {
  FieldGoals goals = Goals({{"r1", {{11.0, 20.0}, {0.0, 0.0}}}});
  const auto kept = goals.Receive(FieldState(100));
  CHECK(kept->goals.left == std::vector<Position>{{11.0, 20.0}});
  CHECK_THAT(goals.robots().at("r1").outside, Catch::Contains("(0, 0)"));
}

TEST_CASE("a restart goes on with the mission, another mission begins from its start",
          "[operator][goals]") {
  const Mission mission{{"r1", {{11.0, 20.0}, {9.0, 20.0}}}};
  FieldGoals before = Goals(mission);
  before.Receive(FieldState(100));
  const KeptGoals stored = *before.Receive(FieldState(200, {11.0, 20.0}));
  FieldGoals same = Goals(mission, {{"r1", stored}});
  CHECK(same.Receive(FieldState(300))->goals.left == std::vector<Position>{{9.0, 20.0}});
  FieldGoals other = Goals({{"r1", {{11.0, 20.0}}}}, {{"r1", stored}});
  const KeptGoals begun = *other.Receive(FieldState(50));
  CHECK(begun.goals.left == std::vector<Position>{{11.0, 20.0}});
  CHECK(begun.goals.stamp >= stored.goals.stamp);
}

}  // namespace
}  // namespace conav::operators
