#include <catch2/catch.hpp>
#include <numbers>

#include "common/grid/geometry.h"
#include "sim/world/world_spec.h"

namespace conav::sim {
namespace {

constexpr auto kWall = Occupancy::kOccupied;

/// 3 x 4, a wall in the truth's north-west corner and one in the map's south-east corner.
WorldSpec SmallWorld() {
  WorldSpec spec;
  spec.truth = OccupancyGrid(3, 4, Occupancy::kFree);
  spec.truth[{0, 0}] = kWall;
  spec.human_map = OccupancyGrid(3, 4, Occupancy::kFree);
  spec.human_map[{2, 3}] = kWall;
  spec.wall_classes = Grid<char>(3, 4, '*');
  spec.wall_classes[{0, 3}] = '7';
  spec.floor_classes = Grid<char>(3, 4, '.');
  spec.floor_classes[{1, 1}] = 'A';
  spec.starts = {{1, 0}};
  spec.goals = {{{0, 1}, {2, 2}}};
  return spec;
}

TEST_CASE("A quarter turn takes the east side to the north", "[sim][world]") {
  const WorldSpec turned = *Rotated(SmallWorld(), 90);
  REQUIRE(turned.truth.rows() == 4);
  REQUIRE(turned.truth.columns() == 3);
  CHECK(turned.truth[{3, 0}] == kWall);
  CHECK(turned.human_map[{0, 2}] == kWall);
  CHECK(turned.wall_classes[{0, 0}] == '7');
  CHECK(turned.floor_classes[{2, 1}] == 'A');
  CHECK(turned.starts == std::vector<Cell>{{3, 1}});
  CHECK(turned.goals == std::vector<std::vector<Cell>>{{{2, 0}, {1, 2}}});
  CHECK(turned.start_heading_rad == Approx(std::numbers::pi / 2));
}

TEST_CASE("Half a turn mirrors rows and columns, none changes nothing", "[sim][world]") {
  const WorldSpec world = SmallWorld();
  CHECK(Rotated(world, 0)->truth == world.truth);
  CHECK(Rotated(world, 0)->start_heading_rad == 0.0);
  const WorldSpec turned = *Rotated(world, 180);
  CHECK(turned.truth[{2, 3}] == kWall);
  CHECK(turned.goals == std::vector<std::vector<Cell>>{{{2, 2}, {0, 1}}});
  CHECK(Rotated(*Rotated(world, 90), 270)->truth == world.truth);
}

TEST_CASE("Other angles are refused", "[sim][world]") {
  for (const int angle : {-90, 45, 360}) {
    const auto refused = Rotated(SmallWorld(), angle);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().text == fmt::format("rotation_deg = {} is not 0, 90, 180 or 270", angle));
  }
}

TEST_CASE("A turned maze is the same maze: as far to its goals, as wrong on the map",
          "[sim][world]") {
  WorldOptions options;
  options.seed = 234;
  const WorldSpec world = *MakeWorldSpec(options);
  for (const int angle : {90, 180, 270}) {
    options.rotation_deg = angle;
    const WorldSpec turned = *MakeWorldSpec(options);
    CHECK(turned.truth != world.truth);
    CHECK(ReachableCells(turned.truth, turned.starts[0]).size() ==
          ReachableCells(world.truth, world.starts[0]).size());
    int wrong_before = 0;
    int wrong_after = 0;
    for (std::size_t i = 0; i < world.truth.size(); ++i) {
      wrong_before += world.truth.values()[i] != world.human_map.values()[i] ? 1 : 0;
      wrong_after += turned.truth.values()[i] != turned.human_map.values()[i] ? 1 : 0;
    }
    CHECK(wrong_after == wrong_before);
    for (const Cell goal : turned.goals[0]) CHECK(turned.truth[goal] == Occupancy::kFree);
  }
}

}  // namespace
}  // namespace conav::sim
