#include "operator/simulated/path_planner.h"

#include <catch2/catch.hpp>

#include "unit/operator/support/drawn_map.h"

namespace conav::operators {
namespace {

using Path = std::vector<Cell>;

Path PlanOn(const BeliefGrid& map, Cell start, const std::vector<Cell>& goals,
            const PathPlannerParameters& parameters = {}, const std::set<Cell>& impassable = {}) {
  const auto path = PathPlanner(parameters).Plan(map, impassable, start, goals);
  REQUIRE(path.has_value());
  return *path;
}

TEST_CASE("The path starts at the robot and ends at the goal", "[operator][simulated]") {
  const BeliefGrid map = DrawnMap({"#####", "#   #", "#####"});
  CHECK(PlanOn(map, {1, 1}, {{1, 3}}) == Path{{1, 1}, {1, 2}, {1, 3}});
}

TEST_CASE("Without a goal the path is the robot's cell", "[operator][simulated]") {
  const BeliefGrid map = DrawnMap({"###", "# #", "###"});
  CHECK(PlanOn(map, {1, 1}, {}) == Path{{1, 1}});
}

// The way around costs 12 steps: down 5, east 2, up 5. Through the wall it is 2 steps and a
// crossing, so a crossing is taken for less than 10 and left for more; at 10 both cost 12.
const std::vector<std::string> kLongWall = {"#####", "# # #", "# # #", "# # #",
                                            "# # #", "# # #", "#   #", "#####"};

TEST_CASE("A wall is crossed where that is cheaper than the way around", "[operator][simulated]") {
  PathPlannerParameters parameters;
  parameters.wall_crossing_cost = 9.0;
  CHECK(PlanOn(DrawnMap(kLongWall), {1, 1}, {{1, 3}}, parameters) == Path{{1, 1}, {1, 2}, {1, 3}});
}

TEST_CASE("A wall is gone around where that is cheaper than to cross it", "[operator][simulated]") {
  PathPlannerParameters parameters;
  parameters.wall_crossing_cost = 11.0;
  const Path path = PlanOn(DrawnMap(kLongWall), {1, 1}, {{1, 3}}, parameters);
  CHECK(path.size() == 13);
  CHECK(path[6] == Cell{6, 2});
}

TEST_CASE("A wall that the operator was told of is never crossed", "[operator][simulated]") {
  PathPlannerParameters parameters;
  parameters.wall_crossing_cost = 0.0;
  const Path path = PlanOn(DrawnMap(kLongWall), {1, 1}, {{1, 3}}, parameters,
                           {{1, 2}, {2, 2}, {3, 2}, {4, 2}, {5, 2}});
  CHECK(path.size() == 13);
}

TEST_CASE("The border is never crossed", "[operator][simulated]") {
  // Along the free-looking border the way would be short; inside there is a wall to cross.
  const BeliefGrid map = DrawnMap({"     ", "# # #", "#####"});
  CHECK(PlanOn(map, {1, 1}, {{1, 3}}) == Path{{1, 1}, {1, 2}, {1, 3}});
}

TEST_CASE("Even odds count as a wall, as in the map's accuracy", "[operator][simulated]") {
  PathPlannerParameters parameters;
  parameters.wall_crossing_cost = 1000.0;
  const BeliefGrid map = DrawnMap({"#####", "# ? #", "#   #", "#####"});
  CHECK(PlanOn(map, {1, 1}, {{1, 3}}, parameters) == Path{{1, 1}, {2, 1}, {2, 2}, {2, 3}, {1, 3}});
}

TEST_CASE("The order of goals is the cheapest one, not the nearest first",
          "[operator][simulated]") {
  // Robot at column 4 with goals at 3, 6 and 1. Nearest first is 3 (1), 1 (2), 6 (5): 8 steps.
  // The cheapest is 6 (2), 3 (3), 1 (2): 7 steps.
  const BeliefGrid map = DrawnMap({"########", "#      #", "########"});
  const Path path = PlanOn(map, {1, 4}, {{1, 3}, {1, 6}, {1, 1}});
  CHECK(path.size() == 8);
  CHECK(path[2] == Cell{1, 6});
  CHECK(path.back() == Cell{1, 1});
}

TEST_CASE("The horizon next_goal ends at the first goal of the tour", "[operator][simulated]") {
  PathPlannerParameters parameters;
  parameters.horizon = "next_goal";
  const BeliefGrid map = DrawnMap({"########", "#      #", "########"});
  CHECK(PlanOn(map, {1, 4}, {{1, 3}, {1, 6}, {1, 1}}, parameters) == Path{{1, 4}, {1, 5}, {1, 6}});
}

TEST_CASE("The horizon away leads to the free cell that is farthest from the goals",
          "[operator][simulated]") {
  const BeliefGrid map = DrawnMap({"#######", "#     #", "# ### #", "# #   #", "#######"});
  PathPlannerParameters parameters;
  parameters.horizon = "away";
  const Path path = PlanOn(map, {1, 3}, {{3, 1}}, parameters);
  CHECK(path.back() == Cell{3, 3});
  CHECK(path.size() == 7);
  CHECK(PlanOn(map, {1, 3}, {}, parameters) == Path{{1, 3}});
}

TEST_CASE("More than six goals are visited nearest first, all of them", "[operator][simulated]") {
  const BeliefGrid map = DrawnMap({"###########", "#         #", "###########"});
  const Path path = PlanOn(map, {1, 4}, {{1, 3}, {1, 2}, {1, 1}, {1, 6}, {1, 7}, {1, 8}, {1, 9}});
  // West to (1,1) first: the goal beside the robot is nearest, then its neighbour, and so on.
  CHECK(path[3] == Cell{1, 1});
  CHECK(path.back() == Cell{1, 9});
  CHECK(path.size() == 12);
}

TEST_CASE("A goal behind certain walls is left out", "[operator][simulated]") {
  const BeliefGrid map = DrawnMap({"#####", "#   #", "#####"});
  CHECK(PlanOn(map, {1, 1}, {{1, 3}}, {}, {{1, 2}}) == Path{{1, 1}});
}

TEST_CASE("A start or a goal outside of the map is refused by name", "[operator][simulated]") {
  const BeliefGrid map = DrawnMap({"###", "# #", "###"});
  const PathPlanner planner({});
  const auto start = planner.Plan(map, {}, {3, 1}, {});
  REQUIRE_FALSE(start.has_value());
  CHECK(start.error().text.find("(3,1)") != std::string::npos);
  CHECK_FALSE(planner.Plan(map, {}, {1, 1}, std::vector<Cell>{{1, -1}}).has_value());
}

TEST_CASE("Following the first step makes the rest of the plan cheaper", "[operator][simulated]") {
  // Teleoperation takes one step and asks again: it must come nearer each time, ties or not.
  const BeliefGrid map = DrawnMap({"#######", "#     #", "#     #", "#     #", "#######"});
  const std::vector<Cell> goals = {{1, 1}, {1, 5}, {3, 1}, {3, 5}};
  std::set<Cell> left(goals.begin(), goals.end());
  Cell robot{2, 3};
  std::size_t length = 100;
  while (!left.empty()) {
    const Path path = PlanOn(map, robot, {left.begin(), left.end()});
    REQUIRE(path.size() < length);
    length = path.size();
    robot = path.at(1);
    left.erase(robot);
  }
}

}  // namespace
}  // namespace conav::operators
