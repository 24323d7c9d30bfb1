#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/grid/cell.h"
#include "common/grid/geometry.h"

/// Positions that others sent, as cells of a map.
namespace conav::operators {

/// Nothing for what is no number, or not on the map.
std::optional<Cell> CellAt(Position position, const GridGeometry& grid);

/// Up to the first position that is not on the map, which no planner of ours sends; 10000 at most.
std::vector<Cell> CellsAt(std::span<const Position> positions, const GridGeometry& grid);

}  // namespace conav::operators
