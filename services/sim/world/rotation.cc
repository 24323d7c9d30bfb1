#include "sim/world/rotation.h"

#include <fmt/format.h>

#include <numbers>

#include "common/grid/geometry.h"

namespace conav::sim {
namespace {

/// Where a quarter turn takes a cell of a grid with `columns` columns.
Cell QuarterTurn(Cell cell, int columns) { return {columns - 1 - cell.column, cell.row}; }

template <class T>
Grid<T> QuarterTurn(const Grid<T>& grid) {
  Grid<T> turned(grid.columns(), grid.rows());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    turned[QuarterTurn(grid.CellAt(i), grid.columns())] = grid.values()[i];
  }
  return turned;
}

WorldSpec QuarterTurn(WorldSpec spec) {
  const int columns = spec.truth.columns();
  for (Cell& start : spec.starts) start = QuarterTurn(start, columns);
  for (std::vector<Cell>& goals : spec.goals) {
    for (Cell& goal : goals) goal = QuarterTurn(goal, columns);
  }
  spec.start_heading_rad = WrapAngle(spec.start_heading_rad + std::numbers::pi / 2);
  spec.truth = QuarterTurn(spec.truth);
  spec.human_map = QuarterTurn(spec.human_map);
  spec.wall_classes = QuarterTurn(spec.wall_classes);
  spec.floor_classes = QuarterTurn(spec.floor_classes);
  return spec;
}

}  // namespace

Result<WorldSpec> Rotated(WorldSpec spec, int rotation_deg) {
  if (rotation_deg < 0 || rotation_deg > 270 || rotation_deg % 90 != 0) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("rotation_deg = {} is not 0, 90, 180 or 270", rotation_deg));
  }
  for (int turned = 0; turned < rotation_deg; turned += 90) spec = QuarterTurn(std::move(spec));
  return spec;
}

}  // namespace conav::sim
