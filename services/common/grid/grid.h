#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/result.h"

namespace conav {

/// A cell of a grid map. Row 0 is the northern edge (+y of the map frame), column 0 the western
/// (-x).
struct Cell {
  int row = 0;
  int column = 0;
  auto operator<=>(const Cell&) const = default;
};

inline Cell operator+(Cell a, Cell b) { return {a.row + b.row, a.column + b.column}; }
inline Cell operator-(Cell a, Cell b) { return {a.row - b.row, a.column - b.column}; }

/// The four neighbours as offsets, in the order north, east, south, west.
inline constexpr std::array<Cell, 4> kNeighbourOffsets{{{-1, 0}, {0, 1}, {1, 0}, {0, -1}}};

inline bool AreNeighbours(Cell a, Cell b) {
  return std::abs(a.row - b.row) + std::abs(a.column - b.column) == 1;
}

}  // namespace conav

template <>
struct std::hash<conav::Cell> {
  std::size_t operator()(conav::Cell cell) const noexcept {
    return static_cast<std::size_t>(static_cast<unsigned>(cell.row)) * 0x9e3779b97f4a7c15ULL ^
           static_cast<std::size_t>(static_cast<unsigned>(cell.column));
  }
};

template <>
struct fmt::formatter<conav::Cell> : fmt::formatter<std::string_view> {
  template <class Context>
  auto format(conav::Cell cell, Context& context) const {
    const std::string text = fmt::format("({},{})", cell.row, cell.column);
    return std::copy(text.begin(), text.end(), context.out());
  }
};

namespace conav {

/// A dense rows x columns array of values, row-major, row 0 north.
template <class T>
class Grid {
 public:
  Grid() = default;
  Grid(int rows, int columns, T value = T{})
      : rows_(rows),
        columns_(columns),
        values_(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns), value) {
    DEMAND(rows >= 0 && columns >= 0, rows, columns);
  }

  int rows() const { return rows_; }
  int columns() const { return columns_; }
  std::size_t size() const { return values_.size(); }

  bool Contains(Cell cell) const {
    return cell.row >= 0 && cell.row < rows_ && cell.column >= 0 && cell.column < columns_;
  }
  bool OnBorder(Cell cell) const {
    return cell.row == 0 || cell.column == 0 || cell.row == rows_ - 1 ||
           cell.column == columns_ - 1;
  }
  std::size_t IndexOf(Cell cell) const {
    return static_cast<std::size_t>(cell.row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(cell.column);
  }
  Cell CellAt(std::size_t index) const {
    return {static_cast<int>(index) / columns_, static_cast<int>(index) % columns_};
  }

  /// Requires Contains(cell).
  decltype(auto) operator[](Cell cell) {
    DEMAND(Contains(cell), cell.row, cell.column, rows_, columns_);
    return values_[IndexOf(cell)];
  }
  decltype(auto) operator[](Cell cell) const {
    DEMAND(Contains(cell), cell.row, cell.column, rows_, columns_);
    return values_[IndexOf(cell)];
  }

  std::span<T> values() { return values_; }
  std::span<const T> values() const { return values_; }

  bool operator==(const Grid&) const = default;

 private:
  int rows_ = 0;
  int columns_ = 0;
  std::vector<T> values_;
};

/// What is known of a cell.
enum class Occupancy : std::uint8_t { kUnknown, kFree, kOccupied };

using OccupancyGrid = Grid<Occupancy>;

/// Probability in [0, 1] that the operator believes the cell is a wall.
using BeliefGrid = Grid<float>;

}  // namespace conav
