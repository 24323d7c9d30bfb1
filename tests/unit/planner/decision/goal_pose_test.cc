#include <catch2/catch.hpp>

#include "planner/decision/robot_worker.h"

using namespace conav;
using namespace conav::planner;

namespace {

struct Scene {
  RobotState state{.world = "w1", .robot = "r1", .cell = {1, 1}};
  MapUpdate map{{}, 2.0, OccupancyGrid(3, 5, Occupancy::kUnknown)};
  Belief belief{.wall_probability = BeliefGrid(3, 5, 0.0F)};
};

}  // namespace

TEST_CASE("a goal pose goes around what the robot knows as wall", "[planner][goal_pose]") {
  Scene scene;
  scene.map.cells[{1, 2}] = Occupancy::kOccupied;
  const auto guidance =
      GuidanceTowards({4.0, 0.0}, scene.state, scene.map, scene.belief, std::nullopt);
  REQUIRE(guidance.has_value());
  CHECK(guidance->path.size() == 6);
}

TEST_CASE("a goal pose outside of the map is refused with its cell", "[planner][goal_pose]") {
  Scene scene;
  const auto guidance =
      GuidanceTowards({40.0, 0.0}, scene.state, scene.map, scene.belief, std::nullopt);
  REQUIRE_FALSE(guidance.has_value());
  CHECK(guidance.error().code == ErrorCode::kOutOfRange);
  CHECK(guidance.error().text.find("(1,22)") != std::string::npos);
}

TEST_CASE("a goal pose behind walls on both maps is refused", "[planner][goal_pose]") {
  Scene scene;
  for (int row = 0; row < 3; ++row) scene.belief.wall_probability[{row, 3}] = 1.0F;
  const auto guidance =
      GuidanceTowards({4.0, 0.0}, scene.state, scene.map, scene.belief, std::nullopt);
  REQUIRE_FALSE(guidance.has_value());
  CHECK(guidance.error().code == ErrorCode::kNotFound);
}
