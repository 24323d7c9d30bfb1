#pragma once

#include <algorithm>
#include <set>
#include <vector>

#include "common/grid/grid.h"

namespace conav {

/// Metres, map frame: x east, y north (REP-103, ENU).
struct Position {
  double x_m = 0.0;
  double y_m = 0.0;
  bool operator==(const Position&) const = default;
};

/// Where the cells of a rows x columns grid lie in the map frame: the grid's middle is the origin,
/// row 0 is north. The lower left (south-west) corner is `origin()`, as in nav_msgs/OccupancyGrid.
struct GridGeometry {
  int rows = 0;
  int columns = 0;
  double cell_size_m = 2.0;

  Position CellToPosition(Cell cell) const;
  /// The cell that holds `position`; may lie outside the grid.
  Cell PositionToCell(Position position) const;
  /// South-west corner of the grid.
  Position origin() const;

  bool operator==(const GridGeometry&) const = default;
};

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
