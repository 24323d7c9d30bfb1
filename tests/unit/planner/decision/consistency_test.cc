#include <catch2/catch.hpp>

#include "planner/decision/robot_worker.h"

using namespace conav;
using namespace conav::planner;

namespace {

RobotInputs Fitting() {
  RobotInputs inputs;
  inputs.state = RobotState{.cell = {1, 1}, .goals_left = {{2, 2}}, .path = {{1, 0}, {1, 1}}};
  inputs.map = MapUpdate{{}, 2.0, OccupancyGrid(3, 4, Occupancy::kFree)};
  inputs.belief = Belief{};
  inputs.belief->wall_probability = BeliefGrid(3, 4);
  inputs.guidance = Guidance{.path = {{1, 1}, {1, 3}}};
  return inputs;
}

}  // namespace

TEST_CASE("inputs of one world belong together", "[planner][consistency]") {
  CHECK_FALSE(Inconsistency(Fitting()).has_value());
}

TEST_CASE("what does not fit is named with both values", "[planner][consistency]") {
  RobotInputs inputs = Fitting();
  std::string expected;
  SECTION("operator's map of another size") {
    inputs.belief->wall_probability = BeliefGrid(5, 4);
    expected = "the operator's map has 5x4 cells, the robot's has 3x4";
  }
  SECTION("true map of another size") {
    inputs.truth = OccupancyGrid(3, 5);
    expected = "the true map has 3x5 cells, the robot's has 3x4";
  }
  SECTION("robot outside of its map") {
    inputs.state->cell = {3, 1};
    expected = "its cell (3,1) is outside of the robot's 3x4 map";
  }
  SECTION("path outside of the map") {
    inputs.state->path = {{0, 4}};
    expected = "cell of its path (0,4) is outside of the robot's 3x4 map";
  }
  SECTION("goal outside of the map") {
    inputs.state->goals_left = {{1, 1}, {9, 9}};
    expected = "goal (9,9) is outside of the robot's 3x4 map";
  }
  SECTION("guidance outside of the map") {
    inputs.guidance->path = {{-1, 0}};
    expected = "cell of its guidance (-1,0) is outside of the robot's 3x4 map";
  }
  SECTION("robot in a wall") {
    inputs.map->cells[{1, 1}] = Occupancy::kOccupied;
    expected = "its cell (1,1) is a wall on its own map";
  }
  CHECK(Inconsistency(inputs) == expected);
}
