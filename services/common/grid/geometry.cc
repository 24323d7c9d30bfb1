#include "common/grid/geometry.h"

#include <fmt/core.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "common/runtime/result.h"

namespace conav {

namespace {

/// Of a place relative to the middle; a middle at 0 changes no bit of it, nor its sign.
Position Shifted(Position place, Position middle) {
  if (middle == Position{}) return place;
  return {place.x_m + middle.x_m, place.y_m + middle.y_m};
}

}  // namespace

Position GridGeometry::CellToPosition(Cell cell) const {
  return Shifted({(cell.column - (columns - 1) / 2.0) * cell_size_m,
                  -(cell.row - (rows - 1) / 2.0) * cell_size_m},
                 middle);
}

Cell GridGeometry::PositionToCell(Position position) const {
  const double column = (position.x_m - middle.x_m) / cell_size_m + columns / 2.0;
  const double row = rows / 2.0 - (position.y_m - middle.y_m) / cell_size_m;
  return {static_cast<int>(std::floor(row)), static_cast<int>(std::floor(column))};
}

Position GridGeometry::origin() const {
  return Shifted({-columns * cell_size_m / 2.0, -rows * cell_size_m / 2.0}, middle);
}

bool AreAligned(const GridGeometry& one, const GridGeometry& other) {
  if (one.rows != other.rows || one.columns != other.columns) return false;
  const double tolerance_m = 0.01 * one.cell_size_m;
  const double stretch_m =
      std::abs(one.cell_size_m - other.cell_size_m) * std::max(one.rows, one.columns);
  return stretch_m <= tolerance_m &&
         std::abs(one.origin().x_m - other.origin().x_m) <= tolerance_m &&
         std::abs(one.origin().y_m - other.origin().y_m) <= tolerance_m;
}

std::string Describe(const GridGeometry& grid) {
  const Position corner = grid.origin();
  return fmt::format("{}x{} cells of {:.4g} m from ({:.4g}, {:.4g}) m", grid.rows, grid.columns,
                     grid.cell_size_m, corner.x_m, corner.y_m);
}

double WrapAngle(double angle_rad) {
  constexpr double kPi = std::numbers::pi;
  double wrapped = std::fmod(angle_rad + kPi, 2.0 * kPi);
  if (wrapped <= 0.0) wrapped += 2.0 * kPi;
  return wrapped - kPi;
}

double HeadingFromIndex(int index, int count) {
  DEMAND(count > 0 && index >= 0 && index < count, index, count);
  return WrapAngle(2.0 * std::numbers::pi * index / count);
}

double HeadingTowards(Cell from, Cell to) {
  return std::atan2(static_cast<double>(from.row - to.row),
                    static_cast<double>(to.column - from.column));
}

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
