#pragma once

#include <array>
#include <string_view>

#include "common/grid/grid.h"

namespace conav {

/// What is wrong with a whole wing of a map.
enum class WingError { kNone, kShifted, kMirrored };
inline constexpr std::array kWingErrors{WingError::kNone, WingError::kShifted,
                                        WingError::kMirrored};
constexpr std::string_view Name(WingError error) {
  return error == WingError::kNone ? "none" : error == WingError::kShifted ? "shifted" : "mirrored";
}

/// A half of a map within its border, and its error along its longer side. What a shift pushes out at
/// one end enters at the other.
struct Wing {
  int side = 0;  // 0 north, 1 south, 2 west, 3 east
  WingError error = WingError::kNone;
  int shift = 2;  // of kShifted, in cells

  /// The same taken back.
  Wing Inverse() const { return {side, error, -shift}; }

  bool Contains(Cell cell, int rows, int columns) const {
    const bool inside =
        cell.row > 0 && cell.column > 0 && cell.row < rows - 1 && cell.column < columns - 1;
    switch (side) {
      case 0:
        return inside && cell.row < rows / 2;
      case 1:
        return inside && cell.row > rows / 2;
      case 2:
        return inside && cell.column < columns / 2;
      default:
        return inside && cell.column > columns / 2;
    }
  }

  /// Where the map with the error shows `cell` of the wing.
  Cell PlaceOf(Cell cell, int rows, int columns) const {
    const bool along_columns = side < 2;
    int& place = along_columns ? cell.column : cell.row;
    const int length = (along_columns ? columns : rows) - 2;
    if (error == WingError::kMirrored) place = length + 1 - place;
    if (error == WingError::kShifted) place = 1 + (place - 1 + shift + length) % length;
    return cell;
  }
};

/// `map` with this error of a wing.
template <class T>
Grid<T> WithError(const Grid<T>& map, const Wing& wing) {
  Grid<T> wrong = map;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Cell cell = map.CellAt(i);
    if (!wing.Contains(cell, map.rows(), map.columns())) continue;
    wrong[wing.PlaceOf(cell, map.rows(), map.columns())] = map[cell];
  }
  return wrong;
}

}  // namespace conav
