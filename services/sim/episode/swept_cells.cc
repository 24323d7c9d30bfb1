#include "sim/episode/swept_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace conav::sim {
namespace {

/// Distance between the discs that stand for a way; small beside the margin of the body.
constexpr double kSampleM = 0.05;

void AddCellsUnder(const GridGeometry& geometry, Position position, std::vector<Cell>& cells) {
  const Position north_west{position.x_m - kBodyRadiusM, position.y_m + kBodyRadiusM};
  const Position south_east{position.x_m + kBodyRadiusM, position.y_m - kBodyRadiusM};
  const Cell first = geometry.PositionToCell(north_west);
  const Cell last = geometry.PositionToCell(south_east);
  for (int row = first.row; row <= last.row; ++row) {
    for (int column = first.column; column <= last.column; ++column) {
      const Cell cell{row, column};
      if (DistanceToCell(geometry, position, cell) >= kBodyRadiusM) continue;
      if (std::find(cells.begin(), cells.end(), cell) == cells.end()) cells.push_back(cell);
    }
  }
}

/// Share of the way from `from` to `to` at which a coordinate passes `edge`.
double ShareUntil(double edge, double from, double to) { return (edge - from) / (to - from); }

}  // namespace

double DistanceToCell(const GridGeometry& geometry, Position position, Cell cell) {
  const Position centre = geometry.CellToPosition(cell);
  const double half = geometry.cell_size_m / 2.0;
  const double dx = std::max(std::abs(position.x_m - centre.x_m) - half, 0.0);
  const double dy = std::max(std::abs(position.y_m - centre.y_m) - half, 0.0);
  return std::hypot(dx, dy);
}

Position Ahead(Position from, double heading_rad, double distance_m) {
  return {from.x_m + distance_m * std::cos(heading_rad),
          from.y_m + distance_m * std::sin(heading_rad)};
}

std::vector<Cell> CellsSwept(const GridGeometry& geometry, Position from, Position to) {
  std::vector<Cell> cells;
  const double length = std::hypot(to.x_m - from.x_m, to.y_m - from.y_m);
  const int samples = static_cast<int>(std::ceil(length / kSampleM));
  AddCellsUnder(geometry, from, cells);
  for (int i = 1; i <= samples; ++i) {
    const double share = static_cast<double>(i) / samples;
    AddCellsUnder(geometry,
                  {from.x_m + share * (to.x_m - from.x_m), from.y_m + share * (to.y_m - from.y_m)},
                  cells);
  }
  return cells;
}

std::vector<Cell> CellsEntered(const GridGeometry& geometry, Position from, Position to) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  std::vector<Cell> cells;
  Cell cell = geometry.PositionToCell(from);
  const Cell last = geometry.PositionToCell(to);
  while (cell != last) {
    const Position centre = geometry.CellToPosition(cell);
    const double half = geometry.cell_size_m / 2.0;
    const int east = last.column > cell.column ? 1 : -1;
    const int south = last.row > cell.row ? 1 : -1;
    const double along_row = last.column == cell.column
                                 ? kNever
                                 : ShareUntil(centre.x_m + east * half, from.x_m, to.x_m);
    const double along_column =
        last.row == cell.row ? kNever : ShareUntil(centre.y_m - south * half, from.y_m, to.y_m);
    cell = along_row <= along_column ? cell + Cell{0, east} : cell + Cell{south, 0};
    cells.push_back(cell);
  }
  return cells;
}

}  // namespace conav::sim
