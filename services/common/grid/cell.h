#pragma once

#include <fmt/format.h>

#include <array>
#include <compare>
#include <cstddef>
#include <cstdlib>
#include <functional>

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
    return fmt::format_to(context.out(), "({},{})", cell.row, cell.column);
  }
};
