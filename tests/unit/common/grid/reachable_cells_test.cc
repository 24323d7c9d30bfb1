#include <catch2/catch.hpp>

#include "common/grid/geometry.h"

namespace conav {

TEST_CASE("reachable cells end at walls and at what is unknown", "[grid]") {
  OccupancyGrid map(3, 9, Occupancy::kOccupied);
  for (const int column : {1, 2, 3, 5, 6}) map[{1, column}] = Occupancy::kFree;
  map[{1, 7}] = Occupancy::kUnknown;
  CHECK(ReachableCells(map, {1, 6}) == std::set<Cell>{{1, 5}, {1, 6}});
  CHECK(ReachableCells(map, {1, 2}).size() == 3);
}

TEST_CASE("a cell without free neighbours reaches itself alone, also at the edge", "[grid]") {
  CHECK(ReachableCells(OccupancyGrid(1, 1, Occupancy::kFree), {0, 0}) == std::set<Cell>{{0, 0}});
}

}  // namespace conav
