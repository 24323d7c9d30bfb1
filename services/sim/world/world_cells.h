#pragma once

#include <set>
#include <vector>

#include "common/grid/grid.h"
#include "common/runtime/random.h"
#include "common/runtime/result.h"

namespace conav::sim {

/// The largest connected free area; the northernmost one when several are as large. Empty when no
/// cell is free.
std::set<Cell> LargestFreeArea(const OccupancyGrid& truth);

/// Hands out cells, each once: the preferred ones first, in random order, then the others.
class CellDeck {
 public:
  CellDeck(std::vector<Cell> preferred, const std::set<Cell>& all, Random& random);

  /// The next cell that is not in `taken`, which it then is. Errors: kOutOfRange when none is left.
  [[nodiscard]] Result<Cell> Draw(std::set<Cell>& taken);

 private:
  std::vector<Cell> cells_;  // the next one last
};

}  // namespace conav::sim
