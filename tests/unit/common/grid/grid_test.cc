#include "common/grid/grid.h"

#include <catch2/catch.hpp>
#include <unordered_set>

namespace conav {
namespace {

TEST_CASE("a grid stores row-major", "[grid]") {
  Grid<int> grid(2, 3, 0);
  grid[{1, 0}] = 7;
  CHECK(grid.values()[3] == 7);
  CHECK(grid.IndexOf({1, 2}) == 5);
  CHECK(grid.CellAt(5) == Cell{1, 2});
}

TEST_CASE("a grid holds its cells and nothing else, its border is the outermost ring", "[grid]") {
  const Grid<int> grid(2, 3);
  CHECK(grid.Contains({0, 0}));
  CHECK(grid.Contains({1, 2}));
  CHECK_FALSE(grid.Contains({2, 0}));
  CHECK_FALSE(grid.Contains({0, 3}));
  CHECK_FALSE(grid.Contains({-1, 0}));
  CHECK_FALSE(Grid<int>().Contains({0, 0}));
  const Grid<int> wide(3, 4);
  for (const Cell cell : {Cell{0, 1}, Cell{2, 2}, Cell{1, 0}, Cell{1, 3}}) {
    CHECK(wide.OnBorder(cell));
  }
  CHECK_FALSE(wide.OnBorder({1, 1}));
  CHECK_FALSE(wide.OnBorder({1, 2}));
}

TEST_CASE("neighbours share an edge", "[grid]") {
  CHECK(AreNeighbours({1, 1}, {1, 2}));
  CHECK(AreNeighbours({1, 1}, {0, 1}));
  CHECK_FALSE(AreNeighbours({1, 1}, {1, 1}));
  CHECK_FALSE(AreNeighbours({1, 1}, {2, 2}));
  CHECK_FALSE(AreNeighbours({1, 1}, {1, 3}));
}

TEST_CASE("cells hash apart and print as row and column", "[grid]") {
  CHECK(fmt::format("{}", Cell{3, -4}) == "(3,-4)");
  std::unordered_set<std::size_t> hashes;
  for (int row = 0; row < 50; ++row) {
    for (int column = 0; column < 50; ++column) hashes.insert(std::hash<Cell>()({row, column}));
  }
  CHECK(hashes.size() == 2500);
}

}  // namespace
}  // namespace conav
