#pragma once

#include <string>
#include <vector>

#include "common/grid/grid.h"

namespace conav {

/// A belief from a drawing: '#' wall, '?' even odds, anything else free. All lines of one length.
inline BeliefGrid DrawnMap(const std::vector<std::string>& lines) {
  BeliefGrid map(static_cast<int>(lines.size()), static_cast<int>(lines.at(0).size()));
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Cell cell = map.CellAt(i);
    const char drawn =
        lines.at(static_cast<std::size_t>(cell.row)).at(static_cast<std::size_t>(cell.column));
    map[cell] = drawn == '#' ? 1.0F : drawn == '?' ? 0.5F : 0.0F;
  }
  return map;
}

}  // namespace conav
