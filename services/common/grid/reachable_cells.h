#pragma once

#include <set>

#include "common/grid/grid.h"

namespace conav {

/// Free cells that 4-connected steps reach from `from`, itself included.
std::set<Cell> ReachableCells(const OccupancyGrid& truth, Cell from);

}  // namespace conav
