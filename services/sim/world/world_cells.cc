#include "sim/world/world_cells.h"

#include <algorithm>

#include "common/grid/reachable_cells.h"

namespace conav::sim {

std::set<Cell> LargestFreeArea(const OccupancyGrid& truth) {
  std::set<Cell> largest;
  std::set<Cell> seen;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Cell cell = truth.CellAt(i);
    if (truth[cell] != Occupancy::kFree || seen.contains(cell)) continue;
    std::set<Cell> area = ReachableCells(truth, cell);
    seen.insert(area.begin(), area.end());
    if (area.size() > largest.size()) largest = std::move(area);
  }
  return largest;
}

CellDeck::CellDeck(std::vector<Cell> preferred, const std::set<Cell>& all, Random& random) {
  std::vector<Cell> others;
  for (const Cell cell : all) {
    if (std::find(preferred.begin(), preferred.end(), cell) == preferred.end()) {
      others.push_back(cell);
    }
  }
  std::erase_if(preferred, [&](Cell cell) { return !all.contains(cell); });
  random.Shuffle(preferred);
  random.Shuffle(others);
  cells_.assign(others.rbegin(), others.rend());
  cells_.insert(cells_.end(), preferred.rbegin(), preferred.rend());
}

Result<Cell> CellDeck::Draw(std::set<Cell>& taken) {
  while (!cells_.empty()) {
    const Cell cell = cells_.back();
    cells_.pop_back();
    if (taken.insert(cell).second) return cell;
  }
  return Fail(ErrorCode::kOutOfRange, "no free cell is left");
}

}  // namespace conav::sim
