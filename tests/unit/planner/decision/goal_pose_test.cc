#include <catch2/catch.hpp>

#include "planner/decision/robot_worker.h"

using namespace conav;
using namespace conav::planner;

namespace {

struct Scene {
  Result<Guidance> Towards(Position goal) const {
    return GuidanceTowards(goal, {.world = "w1", .robot = "r1", .cell = {1, 1}}, map, belief,
                           std::nullopt);
  }

  MapUpdate map{{}, 2.0, OccupancyGrid(3, 5, Occupancy::kUnknown)};
  Belief belief{.wall_probability = BeliefGrid(3, 5, 0.0F)};
};

}  // namespace

TEST_CASE("a goal pose goes around what the robot knows as wall", "[planner][goal_pose]") {
  Scene scene;
  scene.map.cells[{1, 2}] = Occupancy::kOccupied;
  CHECK(scene.Towards({4.0, 0.0}).value().path.size() == 6);
}

TEST_CASE("a goal pose outside of the map, or behind walls on both maps, is refused",
          "[planner][goal_pose]") {
  Scene scene;
  const auto outside = scene.Towards({40.0, 0.0});
  REQUIRE_FALSE(outside.has_value());
  CHECK(outside.error().code == ErrorCode::kOutOfRange);
  CHECK_THAT(outside.error().text, Catch::Contains("(1,22)"));
  for (int row = 0; row < 3; ++row) scene.belief.wall_probability[{row, 3}] = 1.0F;
  const auto behind = scene.Towards({4.0, 0.0});
  REQUIRE_FALSE(behind.has_value());
  CHECK(behind.error().code == ErrorCode::kNotFound);
}
