#include "common/grid/visibility.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <numbers>
#include <string>

#include "common/grid/map_accuracy.h"
#include "support/drawn_map.h"

namespace conav {
namespace {

OccupancyGrid MapFrom(const std::vector<std::string>& lines) {
  return ToOccupancy(DrawnMap(lines));
}

bool Has(const std::vector<Cell>& cells, Cell cell) {
  return std::find(cells.begin(), cells.end(), cell) != cells.end();
}

CameraView Look(Cell cell, double heading_rad) {
  return {.cell = cell, .heading_rad = heading_rad};
}

TEST_CASE("a corridor is seen to its end, with the walls at its sides", "[visibility]") {
  const OccupancyGrid map = MapFrom({"######", "#    #", "######"});
  const VisibleCells seen = CastView(map, Look({1, 1}, 0.0));
  CHECK(seen.free == std::vector<Cell>{{1, 1}, {1, 2}, {1, 3}, {1, 4}});
  CHECK(Has(seen.walls, {1, 5}));
  CHECK(Has(seen.walls, {0, 2}));
  CHECK(Has(seen.walls, {2, 4}));
  CHECK_FALSE(Has(seen.walls, {1, 0}));
}

TEST_CASE("the camera's own cell is seen also when it looks at a wall", "[visibility]") {
  const OccupancyGrid map = MapFrom({"###", "# #", "###"});
  const VisibleCells seen = CastView(map, Look({1, 1}, std::numbers::pi / 2));
  CHECK(seen.free == std::vector<Cell>{{1, 1}});
  CHECK(Has(seen.walls, {0, 1}));
  CHECK_FALSE(Has(seen.walls, {2, 1}));
}

TEST_CASE("nothing behind a wall or an unknown cell is seen, nor the latter itself",
          "[visibility]") {
  OccupancyGrid map = MapFrom({"#######", "#     #", "#######"});
  for (const Occupancy blocked : {Occupancy::kOccupied, Occupancy::kUnknown}) {
    map[{1, 3}] = blocked;
    const VisibleCells seen = CastView(map, Look({1, 1}, 0.0));
    CHECK(seen.free == std::vector<Cell>{{1, 1}, {1, 2}});
    CHECK(Has(seen.walls, {1, 3}) == (blocked == Occupancy::kOccupied));
    CHECK_FALSE(Has(seen.walls, {1, 6}));
  }
}

TEST_CASE("a wider field of view sees more", "[visibility]") {
  const OccupancyGrid map(11, 11, Occupancy::kFree);
  CameraView view = Look({5, 1}, 0.0);
  view.horizontal_fov_rad = 0.5;
  const std::size_t narrow = CastView(map, view).free.size();
  view.horizontal_fov_rad = 2.0;
  CHECK(CastView(map, view).free.size() > narrow);
}

TEST_CASE("visible cells turn with the map", "[visibility]") {
  const OccupancyGrid map = MapFrom({"#####", "#   #", "# # #", "#   #", "#####"});
  const std::size_t east = CastView(map, Look({1, 1}, 0.0)).free.size();
  const std::size_t south = CastView(map, Look({1, 1}, -std::numbers::pi / 2)).free.size();
  CHECK(east == south);
  CHECK(Has(CastView(map, Look({1, 1}, 0.0)).free, {1, 3}));
  CHECK(Has(CastView(map, Look({1, 1}, -std::numbers::pi / 2)).free, {3, 1}));
}

TEST_CASE("lists are sorted and without repeats", "[visibility]") {
  const OccupancyGrid map = MapFrom({"#####", "#   #", "#   #", "#   #", "#####"});
  for (int heading = 0; heading < 8; ++heading) {
    const VisibleCells seen = CastView(map, Look({2, 2}, heading * std::numbers::pi / 4));
    for (const auto& cells : {seen.free, seen.walls}) {
      CHECK(std::ranges::adjacent_find(cells, std::greater_equal()) == cells.end());
    }
  }
}

TEST_CASE("a camera that looks down sees wider near by, not far away", "[visibility]") {
  const OccupancyGrid open(11, 11, Occupancy::kFree);
  CameraView level = Look({5, 1}, 0.0);
  level.height_cells = 1.5;
  level.horizontal_fov_rad = 1.2;
  level.pitch_rad = 0.0;
  CameraView down = level;
  down.pitch_rad = 0.45;
  const VisibleCells seen_level = CastView(open, level);
  const VisibleCells seen_down = CastView(open, down);
  // Half a cell aside within 0.425 cells ahead: outside of 34 degrees, inside of the lower corners.
  CHECK_FALSE(Has(seen_level.free, {4, 1}));
  CHECK(Has(seen_down.free, {4, 1}));
  CHECK(Has(seen_down.free, {5, 10}));
  CHECK_FALSE(Has(seen_down.free, {0, 7}));
}

TEST_CASE("a range sensor sees around itself up to its distance", "[visibility]") {
  const OccupancyGrid open(9, 9, Occupancy::kFree);
  const VisibleCells seen = CastRange(open, {4, 4}, 2.0);
  CHECK(seen.free.size() == 13);  // all cells whose centre is at most 2 away
  CHECK(Has(seen.free, {2, 4}));
  CHECK(Has(seen.free, {5, 5}));
  CHECK_FALSE(Has(seen.free, {6, 5}));
}

TEST_CASE("a range sensor does not see through walls, nor beyond its cell by distance 0",
          "[visibility]") {
  const OccupancyGrid map = MapFrom({"#####", "# # #", "#####"});
  const VisibleCells seen = CastRange(map, {1, 1}, 3.0);
  CHECK(seen.free == std::vector<Cell>{{1, 1}});
  CHECK(Has(seen.walls, {1, 2}));
  CHECK_FALSE(Has(seen.walls, {1, 4}));
  const OccupancyGrid open(5, 5, Occupancy::kFree);
  CHECK(CastRange(open, {2, 2}, 0.0).free == std::vector<Cell>{{2, 2}});
}

TEST_CASE("a range sensor sees the walls of its own cell on all sides", "[visibility]") {
  const OccupancyGrid map = MapFrom({"###", "# #", "###"});
  const VisibleCells seen = CastRange(map, {1, 1}, 1.0);
  CHECK(seen.walls == std::vector<Cell>{{0, 1}, {1, 0}, {1, 2}, {2, 1}});
}

}  // namespace
}  // namespace conav
