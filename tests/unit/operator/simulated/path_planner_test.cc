#include "operator/simulated/path_planner.h"

#include <catch2/catch.hpp>

#include "support/drawn_map.h"

namespace conav::operators {
namespace {

using Path = std::vector<Cell>;
using Drawing = std::vector<std::string>;

Path PlanOn(const Drawing& map, Cell start, const Path& goals,
            const PathPlannerParameters& parameters = {}, const std::set<Cell>& impassable = {}) {
  const auto path = PathPlanner(parameters).Plan(DrawnMap(map), impassable, start, goals);
  REQUIRE(path.has_value());
  return *path;
}

const Drawing kCorridor = {"#####", "#   #", "#####"};
const Drawing kLongCorridor = {"########", "#      #", "########"};
/// The way around costs 12 steps: down 5, east 2, up 5. Through the wall it is 2 steps and a
/// crossing, so a crossing is taken for less than 10 and left for more; at 10 both cost 12.
const Drawing kLongWall = {"#####", "# # #", "# # #", "# # #", "# # #", "# # #", "#   #", "#####"};
const Path kAcross = {{1, 1}, {1, 2}, {1, 3}};
const Path kAround = {{1, 1}, {2, 1}, {3, 1}, {4, 1}, {5, 1}, {6, 1}, {6, 2},
                      {6, 3}, {5, 3}, {4, 3}, {3, 3}, {2, 3}, {1, 3}};

TEST_CASE("A path leads from the robot to the goal that the map has a way to", "[simulated]") {
  CHECK(PlanOn(kCorridor, {1, 1}, {{1, 3}}) == kAcross);
  CHECK(PlanOn(kCorridor, {1, 1}, {}) == Path{{1, 1}});
  CHECK(PlanOn(kCorridor, {1, 1}, {{1, 3}}, {}, {{1, 2}}) == Path{{1, 1}});  // behind certain walls
}

TEST_CASE("A wall is crossed where that is cheaper than the way around", "[simulated]") {
  const std::set<Cell> known{{1, 2}, {2, 2}, {3, 2}, {4, 2}, {5, 2}};
  CHECK(PlanOn(kLongWall, {1, 1}, {{1, 3}}, {.wall_crossing_cost = 9.0}) == kAcross);
  CHECK(PlanOn(kLongWall, {1, 1}, {{1, 3}}, {.wall_crossing_cost = 11.0}) == kAround);
  CHECK(PlanOn(kLongWall, {1, 1}, {{1, 3}}, {.wall_crossing_cost = 0.0}, known) == kAround);
  // Along the free-looking border the way would be short, but it is never crossed.
  CHECK(PlanOn({"     ", "# # #", "#####"}, {1, 1}, {{1, 3}}) == kAcross);
  // Even odds count as a wall, as in the map's accuracy.
  CHECK(PlanOn({"#####", "# ? #", "#   #", "#####"}, {1, 1}, {{1, 3}},
               {.wall_crossing_cost = 1000.0}) == Path{{1, 1}, {2, 1}, {2, 2}, {2, 3}, {1, 3}});
}

TEST_CASE("The order of goals is the cheapest one, of more than six the nearest first",
          "[simulated]") {
  // Robot at column 4 with goals at 3, 6 and 1. Nearest first is 3 (1), 1 (2), 6 (5): 8 steps.
  // The cheapest is 6 (2), 3 (3), 1 (2): 7 steps.
  const Path goals{{1, 3}, {1, 6}, {1, 1}};
  const Path path = PlanOn(kLongCorridor, {1, 4}, goals);
  CHECK(path.size() == 8);
  CHECK(path[2] == Cell{1, 6});
  CHECK(path.back() == Cell{1, 1});
  CHECK(PlanOn(kLongCorridor, {1, 4}, goals, {.horizon = "next_goal"}) ==
        Path{{1, 4}, {1, 5}, {1, 6}});
  const Path many = PlanOn({"###########", "#         #", "###########"}, {1, 4},
                           {{1, 3}, {1, 2}, {1, 1}, {1, 6}, {1, 7}, {1, 8}, {1, 9}});
  CHECK(many[3] == Cell{1, 1});
  CHECK(many.back() == Cell{1, 9});
  CHECK(many.size() == 12);
}

TEST_CASE("The horizon away leads to the free cell that is farthest from the goals",
          "[simulated]") {
  const Drawing map = {"#######", "#     #", "# ### #", "# #   #", "#######"};
  CHECK(PlanOn(map, {1, 3}, {{3, 1}}, {.horizon = "away"}) ==
        Path{{1, 3}, {1, 4}, {1, 5}, {2, 5}, {3, 5}, {3, 4}, {3, 3}});
  CHECK(PlanOn(map, {1, 3}, {}, {.horizon = "away"}) == Path{{1, 3}});
}

TEST_CASE("A start or a goal outside of the map is refused by name", "[simulated]") {
  const BeliefGrid map = DrawnMap({"###", "# #", "###"});
  const PathPlanner planner({});
  const auto start = planner.Plan(map, {}, {3, 1}, {});
  REQUIRE_FALSE(start.has_value());
  CHECK_THAT(start.error().text, Catch::Contains("(3,1)"));
  CHECK_FALSE(planner.Plan(map, {}, {1, 1}, Path{{1, -1}}).has_value());
}

TEST_CASE("Following the first step makes the rest of the plan cheaper", "[simulated]") {
  // Teleoperation takes one step and asks again: it must come nearer each time, ties or not.
  const Drawing map = {"#######", "#     #", "#     #", "#     #", "#######"};
  std::set<Cell> left{{1, 1}, {1, 5}, {3, 1}, {3, 5}};
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

TEST_CASE("On a raster a path keeps off the shore, but takes a narrow channel", "[simulated]") {
  // A bay 13 rows high, then a channel of one row at its southern shore, 1 m a cell.
  BeliefGrid map(15, 40, 0.0F);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Cell cell = map.CellAt(i);
    if (map.OnBorder(cell) || (cell.column > 30 && cell.row != 13)) map[cell] = 1.0F;
  }
  const auto path = PathPlanner({}, 1.0).Plan(map, {}, {13, 1}, Path{{13, 38}});
  REQUIRE(path.has_value());
  CHECK(path->back() == Cell{13, 38});
  for (const Cell cell : *path) {
    if (cell.column > 8 && cell.column < 24) CHECK(cell.row <= 10);  // 3 m or more from the shore
  }
  const auto maze = PathPlanner({}, 2.0).Plan(map, {}, {13, 1}, Path{{13, 38}});
  REQUIRE(maze.has_value());
  CHECK(maze->size() == 38);  // straight along the shore
}

TEST_CASE("On a raster a path crosses land only where the map has no other way", "[simulated]") {
  // Two basins behind a wall of one cell, 40 rows long but for a gap at its end.
  BeliefGrid map(42, 12, 0.0F);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Cell cell = map.CellAt(i);
    if (map.OnBorder(cell) || (cell.column == 6 && cell.row < 36)) map[cell] = 1.0F;
  }
  const Path goal{{2, 9}};
  const auto around = PathPlanner({}, 1.0).Plan(map, {}, {2, 2}, goal);
  REQUIRE(around.has_value());
  CHECK(around->size() > 70);
  CHECK(PathPlanner({}, 2.0).Plan(map, {}, {2, 2}, goal).value().size() < 20);  // in a maze
  for (int row = 36; row < 41; ++row) map[{row, 6}] = 1.0F;
  CHECK(PathPlanner({}, 1.0).Plan(map, {}, {2, 2}, goal).value().back() == goal.front());
}

TEST_CASE("On a raster a path goes straight to its goal, over 4-connected cells", "[simulated]") {
  BeliefGrid map(30, 30, 0.0F);
  const Path path = PathPlanner({}, 1.0).Plan(map, {}, {6, 6}, Path{{23, 23}}).value();
  CHECK(path.size() == 2 * 17 + 1);
  for (std::size_t i = 0; i < path.size(); ++i) {
    CHECK(std::abs(path[i].row - path[i].column) <= 1);
    if (i > 0)
      CHECK(std::abs(path[i].row - path[i - 1].row + path[i].column - path[i - 1].column) == 1);
  }
}

TEST_CASE("A diagonal costs what the dearer of its two steps does, at the cheaper corner",
          "[simulated]") {
  // 1 4
  // 9 2
  Grid<double> costs(2, 2, 1.0);
  costs[{0, 1}] = 4.0;
  costs[{1, 0}] = 9.0;
  costs[{1, 1}] = 2.0;
  const CostField field(costs, {0, 0}, true);
  CHECK(field.CostTo({1, 1}) == Approx(4.0 * std::sqrt(2.0)));
  CHECK(field.PathTo({1, 1}) == Path{{0, 0}, {0, 1}, {1, 1}});
  CHECK(CostField(costs, {0, 0}).CostTo({1, 1}) == 6.0);
}

TEST_CASE("The cost to a cell is the sum of the entry costs on the cheapest way", "[simulated]") {
  // 1 9 1
  // 1 1 1
  Grid<double> costs(2, 3, 1.0);
  costs[{0, 1}] = 9.0;
  const CostField field(costs, {0, 0});
  CHECK(field.CostTo({0, 0}) == 0.0);
  CHECK(field.PathTo({0, 0}) == Path{{0, 0}});
  CHECK(field.CostTo({0, 1}) == 9.0);
  CHECK(field.CostTo({0, 2}) == 4.0);  // around: down, east, east, up
  CHECK(field.PathTo({0, 2}) == Path{{0, 0}, {1, 0}, {1, 1}, {1, 2}, {0, 2}});
  // Of ways of equal cost always the same: (0,1) is settled before (1,0), and (1,1) entered from it.
  CHECK(CostField(Grid<double>(2, 2, 1.0), {0, 0}).PathTo({1, 1}) == Path{{0, 0}, {0, 1}, {1, 1}});
  costs[{0, 1}] = costs[{1, 1}] = kUnreachable;
  CHECK(CostField(costs, {0, 0}).CostTo({0, 2}) == kUnreachable);
}

}  // namespace
}  // namespace conav::operators
