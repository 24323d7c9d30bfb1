#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <set>

#include "common/runtime/random.h"
#include "sim/physics/camera.h"
#include "unit/sim/physics/mazes.h"

/// CastView, the two-dimensional model of what a picture shows, against MuJoCo's segmentation of
/// the picture itself (docs/paper.md).
namespace conav::sim {
namespace {

using test::MakeWorld;

constexpr int kPoses = 100;
constexpr int kCoveredPixels = 20;

struct Shown {
  std::map<Cell, int> floor;  // pixels by cell
  std::map<Cell, int> walls;
};

Shown CountPixels(const Grid<PixelLabel>& labels) {
  Shown shown;
  for (const PixelLabel& label : labels.values()) {
    if (label.kind == PixelKind::kFloor) ++shown.floor[label.cell];
    if (label.kind == PixelKind::kWall) ++shown.walls[label.cell];
  }
  return shown;
}

struct Tally {
  int covered = 0;  // cells of at least kCoveredPixels
  int missed = 0;   // of these, not in CastView
  int walls = 0;    // walls in CastView
  int unshown = 0;  // of these, without a single pixel
};

void Compare(const std::map<Cell, int>& shown, const std::vector<Cell>& cast, Tally& tally) {
  for (const auto& [cell, pixels] : shown) {
    if (pixels < kCoveredPixels) continue;
    ++tally.covered;
    if (!std::ranges::binary_search(cast, cell)) ++tally.missed;
  }
}

TEST_CASE("CastView agrees with MuJoCo's segmentation", "[sim][physics][camera]") {
  const auto [width, height] =
      GENERATE(std::pair{320, 192}, std::pair{640, 480}, std::pair{256, 256});
  const test::Rows& rows =
      GENERATE(std::cref(test::kMaze), std::cref(test::kWideMaze), std::cref(test::kHall));
  const double cell_size_m = GENERATE(1.0, 2.0);
  const PhysicsWorld spec = MakeWorld(rows, {1, 1}, cell_size_m);
  auto world_result = RobotWorld::Create(spec);
  REQUIRE(world_result);
  RobotWorld& world = **world_result;
  auto camera_result = Camera::Open(world, {width, height});
  REQUIRE(camera_result);
  Tally tally;
  Random random(11);
  const std::vector<Cell> cells = test::FreeCells(spec.truth);
  for (int pose = 0; pose < kPoses; ++pose) {
    const Cell cell = cells[static_cast<std::size_t>(
        random.Uniform(0, static_cast<std::int64_t>(cells.size()) - 1))];
    const double heading_rad = HeadingFromIndex(static_cast<int>(random.Uniform(0, 23)), 24);
    world.Teleport(0, world.geometry().CellToPosition(cell), heading_rad);
    const Shown shown = CountPixels((*camera_result)->RenderSegmentation(0));
    const VisibleCells cast =
        CastView(spec.truth, ViewAt(cell, heading_rad, cell_size_m, width, height));
    Compare(shown.floor, cast.free, tally);
    Compare(shown.walls, cast.walls, tally);
    for (const Cell wall : cast.walls) {
      ++tally.walls;
      if (!shown.walls.contains(wall)) ++tally.unshown;
    }
  }
  CAPTURE(width, height, cell_size_m, tally.covered, tally.walls);
  CHECK(tally.covered > 500);
  CHECK(tally.missed == 0);
  CHECK(tally.unshown <= tally.walls / 100);  // slivers under a pixel wide
}

}  // namespace
}  // namespace conav::sim
