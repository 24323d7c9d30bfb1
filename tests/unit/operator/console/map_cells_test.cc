#include <catch2/catch.hpp>
#include <limits>

#include "operator/console/console_messages.h"

namespace conav::operators {
namespace {

constexpr GridGeometry kGrid{3, 4, 2.0};

TEST_CASE("positions on the map have a cell, others none", "[operator][console]") {
  CHECK(CellAt({0.5, 0.5}, kGrid) == Cell{1, 2});
  CHECK(CellAt({-3.9, 2.9}, kGrid) == Cell{0, 0});
  const double none = std::numeric_limits<double>::quiet_NaN();
  for (const Position position : {Position{4.1, 0.0}, Position{0.0, -3.1}, Position{1e300, 0.0},
                                  Position{none, 0.0}, Position{0.0, none}}) {
    CHECK_FALSE(CellAt(position, kGrid));
  }
}

TEST_CASE("cells of a path end with the map", "[operator][console]") {
  const std::vector<Position> path{{0.5, 0.5}, {0.5, 2.5}, {0.5, 9.0}, {0.5, 0.5}};
  CHECK(CellsAt(path, kGrid) == std::vector<Cell>{{1, 2}, {0, 2}});
  CHECK(CellsAt({}, kGrid).empty());
}

}  // namespace
}  // namespace conav::operators
