#include "common/grid/reachable_cells.h"

#include <vector>

namespace conav {

std::set<Cell> ReachableCells(const OccupancyGrid& truth, Cell from) {
  std::set<Cell> reached{from};
  std::vector<Cell> open{from};
  while (!open.empty()) {
    const Cell cell = open.back();
    open.pop_back();
    for (const Cell offset : kNeighbourOffsets) {
      const Cell next = cell + offset;
      if (!truth.Contains(next) || truth[next] != Occupancy::kFree) continue;
      if (reached.insert(next).second) open.push_back(next);
    }
  }
  return reached;
}

}  // namespace conav
