#include "operator/console/map_cells.h"

#include <cmath>

namespace conav::operators {
namespace {

constexpr std::size_t kLongest = 10000;

}  // namespace

std::optional<Cell> CellAt(Position position, const GridGeometry& grid) {
  const double limit_m = (grid.rows + grid.columns) * grid.cell_size_m;  // far away has no cell
  if (!(std::abs(position.x_m) < limit_m && std::abs(position.y_m) < limit_m)) return std::nullopt;
  const Cell cell = grid.PositionToCell(position);
  const bool is_on_map =
      cell.row >= 0 && cell.row < grid.rows && cell.column >= 0 && cell.column < grid.columns;
  return is_on_map ? std::optional(cell) : std::nullopt;
}

std::vector<Cell> CellsAt(std::span<const Position> positions, const GridGeometry& grid) {
  std::vector<Cell> cells;
  for (const Position position : positions) {
    const auto cell = CellAt(position, grid);
    if (!cell || cells.size() == kLongest) break;
    cells.push_back(*cell);
  }
  return cells;
}

}  // namespace conav::operators
