#pragma once

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "common/grid/grid.h"

namespace conav {

/// Metres, map frame: x east, y north (REP-103, ENU).
struct Position {
  double x_m = 0.0;
  double y_m = 0.0;
  bool operator==(const Position&) const = default;
};

/// Metres.
inline double Distance(Position a, Position b) { return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m); }

/// Where the cells of a rows x columns grid lie in the map frame: row 0 is north, and the grid's
/// middle is at `middle`, which is the frame's origin in the worlds of the simulator. The lower left
/// (south-west) corner is `origin()`, as in nav_msgs/OccupancyGrid.
struct GridGeometry {
  int rows = 0;
  int columns = 0;
  double cell_size_m = 2.0;
  Position middle{};

  Position CellToPosition(Cell cell) const;
  /// The cell that holds `position`; may lie outside the grid.
  Cell PositionToCell(Position position) const;
  /// South-west corner of the grid.
  Position origin() const;
  bool Contains(Cell cell) const {
    return cell.row >= 0 && cell.row < rows && cell.column >= 0 && cell.column < columns;
  }

  bool operator==(const GridGeometry&) const = default;
};

/// Whether the same cells lie at the same places, to a hundredth of a cell: resolutions are 32-bit
/// numbers on the bus.
bool AreAligned(const GridGeometry& one, const GridGeometry& other);

/// "5x6 cells of 0.5 m from (-3, 2) m".
std::string Describe(const GridGeometry& grid);

/// Headings are yaw_rad: 0 = east (+x), counter-clockwise positive (REP-103).
/// Returns heading `index` of `count` evenly spaced ones, in (-pi, pi].
double HeadingFromIndex(int index, int count);

/// Wraps into (-pi, pi].
double WrapAngle(double angle_rad);

/// Heading from one cell's centre to another's.
double HeadingTowards(Cell from, Cell to);

inline bool Contains(const std::vector<Cell>& cells, Cell cell) {
  return std::ranges::find(cells, cell) != cells.end();
}

/// Free cells that 4-connected steps reach from `from`, including `from`.
std::set<Cell> ReachableCells(const OccupancyGrid& truth, Cell from);

}  // namespace conav
