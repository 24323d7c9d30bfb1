#pragma once

#include <algorithm>
#include <span>

#include "common/grid/grid.h"

namespace conav::planner {

/// Whether no robot can ever be in `cell`, by a robot's own map.
inline bool IsKnownWall(const OccupancyGrid& map, Cell cell) {
  return !map.Contains(cell) || map[cell] == Occupancy::kOccupied;
}

/// Whether a path cannot be gone, by a robot's own map.
inline bool IsKnownBlocked(const OccupancyGrid& map, std::span<const Cell> path) {
  return std::any_of(path.begin(), path.end(), [&](Cell cell) { return IsKnownWall(map, cell); });
}

}  // namespace conav::planner
