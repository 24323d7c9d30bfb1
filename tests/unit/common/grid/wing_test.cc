#include "common/grid/wing.h"

#include <catch2/catch.hpp>

using namespace conav;

TEST_CASE("an error of a wing moves its cells, and its inverse brings them back", "[grid]") {
  Grid<int> map(7, 9, 0);
  for (std::size_t i = 0; i < map.size(); ++i) map.values()[i] = static_cast<int>(i);
  for (int side = 0; side < 4; ++side) {
    for (const Wing& wing : {Wing{side, WingError::kMirrored}, Wing{side, WingError::kShifted, 2},
                             Wing{side, WingError::kShifted, -2}}) {
      CAPTURE(side, Name(wing.error), wing.shift);
      const Grid<int> wrong = WithError(map, wing);
      CHECK_FALSE(wrong == map);
      CHECK(WithError(wrong, wing.Inverse()) == map);
      for (std::size_t i = 0; i < map.size(); ++i) {
        const Cell cell = map.CellAt(i);
        if (!wing.Contains(cell, 7, 9)) CHECK(wrong[cell] == map[cell]);
      }
    }
  }
  // The north wing is mirrored along its rows: column 1 shows what is in column 7.
  const Grid<int> mirrored = WithError(map, Wing{0, WingError::kMirrored});
  CHECK(mirrored[{1, 1}] == map[{1, 7}]);
  CHECK(WithError(map, Wing{2, WingError::kShifted, 2})[{3, 1}] == map[{1, 1}]);
}
