#include "planner/decision/traffic.h"

#include <catch2/catch.hpp>
#include <map>

#include "common/runtime/random.h"
#include "unit/planner/search/text_map.h"

using namespace conav;
using namespace conav::planner;

namespace {

Situation RobotAt(const std::string& robot, Cell cell, const std::vector<std::string_view>& lines) {
  Situation situation;
  situation.state.robot = robot;
  situation.state.cell = cell;
  situation.map.cells = MapFrom(lines);
  return situation;
}

/// A corridor with one bay.
const std::vector<std::string_view> kBay{"#######", "#     #", "### ###", "#######"};

/// Drives robots by nothing but their desired way and the traffic rules, one move of one robot at a
/// time.
struct Fleet {
  std::vector<std::string_view> lines;
  std::map<std::string, Situation> robots;
  Random random{7};

  void Refresh() {
    for (auto& [name, situation] : robots) {
      std::erase(situation.state.goals_left, situation.state.cell);
    }
    for (auto& [name, situation] : robots) {
      situation.neighbours.clear();
      for (const auto& [other, theirs] : robots) {
        if (other != name)
          situation.neighbours.push_back(
              {other, theirs.state.cell, !theirs.state.goals_left.empty(), DesiredWay(theirs)});
      }
    }
  }

  bool Taken(const Situation& situation, Cell cell) const {
    return std::any_of(situation.neighbours.begin(), situation.neighbours.end(),
                       [&](const Neighbour& other) { return other.cell == cell; });
  }

  /// What a robot without any plan of its own does: aside, on its way, or (blocked) anywhere.
  void Move(Situation& situation) {
    if (const auto aside = StepAside(situation, DesiredWay(situation))) {
      situation.state.cell = *aside;
      return;
    }
    const std::vector<Cell> way = DesiredWay(situation);
    if (way.empty()) return;
    if (WaitsFor(situation, way) == nullptr && !Taken(situation, way.front())) {
      situation.state.cell = way.front();
      return;
    }
    if (random.Chance(0.5)) return;
    const Cell next =
        situation.state.cell + kNeighbourOffsets[static_cast<std::size_t>(random.Uniform(0, 3))];
    if (situation.map.cells[next] == Occupancy::kFree && !Taken(situation, next))
      situation.state.cell = next;
  }

  bool Done() const {
    return std::all_of(robots.begin(), robots.end(),
                       [](const auto& entry) { return entry.second.state.goals_left.empty(); });
  }

  /// Rounds until all goals are reached; -1 after 2000.
  int Run() {
    for (int round = 0; round < 2000; ++round) {
      Refresh();
      if (Done()) return round;
      for (auto& [name, situation] : robots) {
        Refresh();
        Move(situation);
      }
    }
    return -1;
  }
};

}  // namespace

TEST_CASE("the desired way is the shortest one over what may be free", "[planner][traffic]") {
  Situation situation = RobotAt("r1", {1, 1}, {"#####", "# ? #", "# # #", "#   #", "#####"});
  situation.state.goals_left = {{1, 3}};
  CHECK(DesiredWay(situation) == std::vector<Cell>{{1, 2}, {1, 3}});
  situation.map.cells[{1, 2}] = Occupancy::kOccupied;
  CHECK(DesiredWay(situation).size() == 6);
}

TEST_CASE("a robot on the way of one that goes before it steps into the bay",
          "[planner][traffic]") {
  Situation situation = RobotAt("r2", {1, 3}, kBay);
  situation.state.goals_left = {{1, 1}};
  situation.neighbours = {{"r1", {1, 2}, true, {{1, 3}, {1, 4}, {1, 5}}}};
  CHECK(StepAside(situation, {}) == Cell{2, 3});
}

TEST_CASE("the robot that goes before stays on its way and waits", "[planner][traffic]") {
  Situation situation = RobotAt("r1", {1, 2}, kBay);
  situation.state.goals_left = {{1, 5}};
  situation.neighbours = {{"r2", {1, 3}, true, {{1, 2}, {1, 1}}}};
  CHECK_FALSE(StepAside(situation, {}).has_value());
  REQUIRE(WaitsFor(situation, DesiredWay(situation)) != nullptr);
  CHECK(WaitsFor(situation, DesiredWay(situation))->robot == "r2");
}

TEST_CASE("a robot without goals makes room for any other", "[planner][traffic]") {
  Situation situation = RobotAt("r1", {1, 3}, kBay);
  situation.neighbours = {{"r2", {1, 4}, true, {{1, 3}, {1, 2}}}};
  CHECK(StepAside(situation, {}) == Cell{2, 3});
}

TEST_CASE("the robot that goes before does not shut in the one that has to make room",
          "[planner][traffic]") {
  Situation situation = RobotAt("r1", {1, 2}, kBay);
  situation.state.goals_left = {{1, 5}};
  situation.neighbours = {{"r2", {1, 4}, true, {{1, 3}, {1, 2}}}};
  // Beyond the bay; from (1,3) on, r2 could not reach it.
  REQUIRE(WaitsFor(situation, DesiredWay(situation)) != nullptr);
  situation.neighbours[0].cell = {2, 3};
  CHECK(WaitsFor(situation, DesiredWay(situation)) == nullptr);
}

TEST_CASE("the robot that goes before backs off from a dead end that it shuts",
          "[planner][traffic]") {
  Situation situation = RobotAt("r1", {1, 3}, kBay);
  situation.state.goals_left = {{1, 5}};
  situation.neighbours = {{"r2", {1, 4}, true, {{1, 3}, {1, 2}}}};
  const auto step = StepAside(situation, DesiredWay(situation));
  REQUIRE(step.has_value());
  CHECK((*step == Cell{2, 3} || *step == Cell{1, 2}));
  SECTION("and the other comes after it") {
    Situation other = RobotAt("r2", {1, 5}, kBay);
    other.neighbours = {{"r1", {1, 3}, true, {{1, 4}, {1, 5}}}};
    CHECK(StepAside(other, {}) == Cell{1, 4});
  }
}

TEST_CASE("a robot far from any way stays", "[planner][traffic]") {
  Situation situation = RobotAt("r2", {2, 3}, kBay);
  situation.neighbours = {{"r1", {1, 2}, true, {{1, 3}, {1, 4}}}};
  CHECK_FALSE(StepAside(situation, {}).has_value());
}

TEST_CASE("head-on meetings, dead ends and parked robots end with all goals reached",
          "[planner][traffic]") {
  Fleet fleet;
  SECTION("head-on in a corridor with one bay") {
    fleet.lines = kBay;
    fleet.robots["r1"] = RobotAt("r1", {1, 1}, kBay);
    fleet.robots["r1"].state.goals_left = {{1, 5}};
    fleet.robots["r2"] = RobotAt("r2", {1, 5}, kBay);
    fleet.robots["r2"].state.goals_left = {{1, 1}};
  }
  SECTION("a finished robot is parked in front of the other's goal") {
    fleet.lines = kBay;
    fleet.robots["r1"] = RobotAt("r1", {1, 4}, kBay);
    fleet.robots["r2"] = RobotAt("r2", {1, 1}, kBay);
    fleet.robots["r2"].state.goals_left = {{1, 5}};
  }
  SECTION("four robots exchange their places around a ring") {
    fleet.lines = {"#######", "#     #", "# ### #", "#     #", "### ###", "#######"};
    const std::vector<std::pair<Cell, Cell>> trips{
        {{1, 1}, {3, 5}}, {{1, 5}, {3, 1}}, {{3, 1}, {1, 5}}, {{3, 5}, {1, 1}}};
    for (std::size_t i = 0; i < trips.size(); ++i) {
      const std::string name = fmt::format("r{}", i + 1);
      fleet.robots[name] = RobotAt(name, trips[i].first, fleet.lines);
      fleet.robots[name].state.goals_left = {trips[i].second};
    }
  }
  SECTION("a robot comes out of a dead end that another wants to enter") {
    fleet.lines = {"########", "#      #", "#### ###", "########"};
    fleet.robots["r1"] = RobotAt("r1", {1, 5}, fleet.lines);
    fleet.robots["r1"].state.goals_left = {{1, 1}};
    fleet.robots["r2"] = RobotAt("r2", {1, 1}, fleet.lines);
    fleet.robots["r2"].state.goals_left = {{1, 6}};
  }
  CHECK(fleet.Run() >= 0);
}
