#pragma once

#include <cstdint>
#include <string>
#include <string_view>

/// What a page makes of the console's grids.
namespace conav::test {

/// The number at the front of `packed`, which it is removed from.
inline std::size_t TakeVarint(std::string_view& packed) {
  std::size_t number = 0;
  for (int shift = 0; !packed.empty(); shift += 7) {
    const auto byte = static_cast<std::uint8_t>(packed.front());
    packed.remove_prefix(1);
    number |= static_cast<std::size_t>(byte & 0x7FU) << shift;
    if (byte < 0x80U) break;
  }
  return number;
}

/// The cells of a grid of idl/console.proto, row-major.
inline std::string UnpackedCells(std::string_view packed) {
  const std::size_t columns = TakeVarint(packed);
  std::string cells;
  while (!packed.empty()) {
    const std::size_t end = cells.size() + TakeVarint(packed);
    const char difference = packed.front();
    packed.remove_prefix(1);
    while (cells.size() < end) {
      const char north = cells.size() < columns ? '\0' : cells[cells.size() - columns];
      cells.push_back(static_cast<char>(north ^ difference));
    }
  }
  return cells;
}

}  // namespace conav::test
