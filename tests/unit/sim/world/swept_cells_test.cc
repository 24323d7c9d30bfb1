#include <catch2/catch.hpp>

#include "sim/world/episode_drive.h"

using namespace conav;
using namespace conav::sim;

namespace {

/// 5 x 5 cells of 2 m; cell (2,2) has the origin in its middle.
const GridGeometry geometry{5, 5, 2.0};

}  // namespace

TEST_CASE("a body in the middle of a cell touches that cell only", "[sim][episode]") {
  CHECK(CellsSwept(geometry, {0.0, 0.0}, {0.0, 0.0}) == std::vector<Cell>{{2, 2}});
}

TEST_CASE("a body near a corner touches the cells that it overlaps and no other",
          "[sim][episode]") {
  CHECK(CellsSwept(geometry, {0.9, 0.0}, {0.9, 0.0}) == std::vector<Cell>{{2, 2}, {2, 3}});
  CHECK(CellsSwept(geometry, {0.9, 0.9}, {0.9, 0.9}).size() == 4);
  // 0.2 m from both edges, but 0.28 m from the corner.
  CHECK(CellsSwept(geometry, {0.8, 0.8}, {0.8, 0.8}) == std::vector<Cell>{{1, 2}, {2, 2}, {2, 3}});
}

TEST_CASE("a way sweeps the cells between its ends, nearest first", "[sim][episode]") {
  CHECK(CellsSwept(geometry, {0.0, 0.0}, {3.0, 0.0}) == std::vector<Cell>{{2, 2}, {2, 3}, {2, 4}});
}

TEST_CASE("the axis enters cells one after the other, also diagonally", "[sim][episode]") {
  CHECK(CellsEntered(geometry, {0.0, 0.0}, {0.5, 0.5}).empty());
  CHECK(CellsEntered(geometry, {0.0, 0.0}, {1.5, 0.0}) == std::vector<Cell>{{2, 3}});
  // East edge first, then the northern one; and the other way round.
  CHECK(CellsEntered(geometry, {0.95, 0.8}, {1.15, 1.1}) == std::vector<Cell>{{2, 3}, {1, 3}});
  CHECK(CellsEntered(geometry, {0.8, 0.95}, {1.1, 1.15}) == std::vector<Cell>{{1, 2}, {1, 3}});
  CHECK(CellsEntered(geometry, {-0.9, -0.9}, {-1.2, -1.2}) == std::vector<Cell>{{2, 1}, {3, 1}});
}

TEST_CASE("the distance to a cell is that to its nearest point", "[sim][episode]") {
  CHECK(DistanceToCell(geometry, {0.3, 0.2}, {2, 2}) == 0.0);
  CHECK(DistanceToCell(geometry, {0.0, 0.0}, {2, 3}) == Approx(1.0));
  CHECK(DistanceToCell(geometry, {0.0, 0.0}, {1, 3}) == Approx(std::sqrt(2.0)));
}

TEST_CASE("ahead is along the heading, and back when negative", "[sim][episode]") {
  CHECK(Ahead({1.0, 1.0}, 0.0, 0.5) == Position{1.5, 1.0});
  CHECK(Ahead({1.0, 1.0}, 0.0, -0.5) == Position{0.5, 1.0});
}
