#include "common/grid/geometry.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

namespace conav {
namespace {

constexpr double kPi = std::numbers::pi;

TEST_CASE("the grid's middle is the origin, row 0 is north", "[geometry]") {
  const GridGeometry geometry{3, 5, 2.0};
  const Position north_west = geometry.CellToPosition({0, 0});
  CHECK(north_west.x_m == -4.0);
  CHECK(north_west.y_m == 2.0);
  const Position middle = geometry.CellToPosition({1, 2});
  CHECK(middle.x_m == 0.0);
  CHECK(middle.y_m == 0.0);
  CHECK(geometry.origin().x_m == -5.0);
  CHECK(geometry.origin().y_m == -3.0);
}

TEST_CASE("a map of another origin is shifted, the default is not, to the bit", "[geometry]") {
  const GridGeometry moved{4, 6, 0.5, {12.0, -7.0}};
  CHECK(moved.origin() == Position{10.5, -8.0});
  CHECK(moved.CellToPosition({0, 0}) == Position{10.75, -6.25});
  CHECK(moved.PositionToCell({10.75, -6.25}) == Cell{0, 0});
  CHECK(moved.PositionToCell({0.0, 0.0}) == Cell{-12, -21});
  const GridGeometry centred{3, 3, 2.0};
  CHECK(std::signbit(centred.CellToPosition({1, 1}).y_m));  // -0, as ever
}

TEST_CASE("grids are aligned when the same cells lie at the same places", "[geometry]") {
  const GridGeometry grid{40, 60, 0.05, {1.0, 2.0}};
  CHECK(AreAligned(grid, grid));
  CHECK(AreAligned(grid, {40, 60, static_cast<double>(0.05F), {1.0, 2.0}}));
  for (const GridGeometry& other :
       {GridGeometry{41, 60, 0.05, {1.0, 2.0}}, GridGeometry{40, 60, 0.0501, {1.0, 2.0}},
        GridGeometry{40, 60, 0.05, {1.01, 2.0}}, GridGeometry{40, 60, 0.05, {1.0, 1.9}},
        GridGeometry{40, 60, 0.05}}) {
    CAPTURE(Describe(other));
    CHECK_FALSE(AreAligned(grid, other));
  }
  CHECK(Describe(GridGeometry{4, 6, 0.5, {12.0, -7.0}}) == "4x6 cells of 0.5 m from (10.5, -8) m");
}

TEST_CASE("every cell's centre lies in that cell, a position off the grid in none", "[geometry]") {
  for (const GridGeometry& geometry : {GridGeometry{13, 13, 2.0}, GridGeometry{4, 7, 0.35},
                                       GridGeometry{9, 4, 0.1, {-73.3, 0.37}}}) {
    for (int row = 0; row < geometry.rows; ++row) {
      for (int column = 0; column < geometry.columns; ++column) {
        const Cell cell{row, column};
        CHECK(geometry.PositionToCell(geometry.CellToPosition(cell)) == cell);
      }
    }
  }
  const GridGeometry geometry{3, 3, 2.0};
  CHECK(geometry.PositionToCell({-3.1, 0.0}).column == -1);
  CHECK(geometry.PositionToCell({0.0, 3.1}).row == -1);
}

TEST_CASE("angles wrap to at most pi and more than -pi", "[geometry]") {
  CHECK(WrapAngle(0.0) == Approx(0.0));
  CHECK(WrapAngle(3 * kPi / 2) == Approx(-kPi / 2));
  CHECK(WrapAngle(-3 * kPi / 2) == Approx(kPi / 2));
  CHECK(WrapAngle(kPi) == Approx(kPi));
  CHECK(WrapAngle(-kPi) == Approx(kPi));
  CHECK(WrapAngle(7.0) == Approx(7.0 - 2 * kPi));
  CHECK(WrapAngle(-1000.0) == Approx(-1000.0 + 159 * 2 * kPi));
}

TEST_CASE(
    "headings begin east and go counter-clockwise, and that to a neighbour is a compass "
    "direction",
    "[geometry]") {
  const Cell towards[] = {{5, 6}, {4, 5}, {5, 4}, {6, 5}};
  const double compass[] = {0.0, kPi / 2, kPi, -kPi / 2};
  for (int i = 0; i < 4; ++i) {
    CHECK(HeadingFromIndex(2 * i, 8) == Approx(compass[i]));
    CHECK(HeadingTowards({5, 5}, towards[i]) == Approx(compass[i]));
  }
}

TEST_CASE("reachable cells end at walls, at what is unknown and at the edge", "[grid]") {
  OccupancyGrid map(3, 9, Occupancy::kOccupied);
  for (const int column : {1, 2, 3, 5, 6}) map[{1, column}] = Occupancy::kFree;
  map[{1, 7}] = Occupancy::kUnknown;
  CHECK(ReachableCells(map, {1, 6}) == std::set<Cell>{{1, 5}, {1, 6}});
  CHECK(ReachableCells(map, {1, 2}).size() == 3);
  CHECK(ReachableCells(OccupancyGrid(1, 1, Occupancy::kFree), {0, 0}) == std::set<Cell>{{0, 0}});
}

}  // namespace
}  // namespace conav
