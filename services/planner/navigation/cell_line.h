#pragma once

#include <cstdlib>

#include "common/grid/grid.h"

namespace conav::planner {

/// Calls `visit` for each cell that the line between two cells' centres touches, both sides of a
/// corner that it goes through included, until `visit` returns false. Returns whether it did not.
/// Exact, so the same cells in either direction.
template <class Visit>
bool WalkLine(Cell from, Cell to, Visit&& visit) {
  const int rows = std::abs(to.row - from.row);
  const int columns = std::abs(to.column - from.column);
  const Cell down{to.row > from.row ? 1 : -1, 0};
  const Cell right{0, to.column > from.column ? 1 : -1};
  Cell cell = from;
  for (int row = 0, column = 0; visit(cell);) {
    if (row == rows && column == columns) return true;
    const int side = (1 + 2 * column) * rows - (1 + 2 * row) * columns;
    if (side == 0 && !(visit(cell + down) && visit(cell + right))) return false;
    if (side <= 0) {
      cell = cell + right;
      ++column;
    }
    if (side >= 0) {
      cell = cell + down;
      ++row;
    }
  }
  return false;
}

}  // namespace conav::planner
