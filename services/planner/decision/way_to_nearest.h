#pragma once

#include <algorithm>
#include <deque>
#include <vector>

#include "common/grid/grid.h"

namespace conav::planner {

/// Breadth-first from `start` to the nearest cell for which `wanted` holds, over cells that
/// `passable` admits; the cells entered, empty when there is none (or it is `start`).
template <class Passable, class Wanted>
std::vector<Cell> WayToNearest(const OccupancyGrid& map, Cell start, Passable&& passable,
                               Wanted&& wanted) {
  Grid<Cell> parent(map.rows(), map.columns(), Cell{-1, -1});
  parent[start] = start;
  std::deque<Cell> open{start};
  while (!open.empty()) {
    const Cell cell = open.front();
    open.pop_front();
    if (wanted(cell)) {
      std::vector<Cell> way;
      for (Cell at = cell; at != start; at = parent[at]) way.push_back(at);
      std::reverse(way.begin(), way.end());
      return way;
    }
    for (const Cell offset : kNeighbourOffsets) {
      const Cell next = cell + offset;
      if (!map.Contains(next) || parent[next].row >= 0 || !passable(next)) continue;
      parent[next] = cell;
      open.push_back(next);
    }
  }
  return {};
}

}  // namespace conav::planner
