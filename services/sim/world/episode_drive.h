#pragma once

#include <vector>

#include "common/grid/geometry.h"

// One user: moves in open terrain; drive actions use the same, in this header's own source.

/// Which cells a robot touches that drives freely, between the centres of cells. The robot is a
/// disc on the floor. Cells may lie outside the grid.
namespace conav::sim {

/// The ball (0.2 m) and a margin.
inline constexpr double kBodyRadiusM = 0.25;

/// From `position` to the nearest point of `cell`, metres; 0 inside.
double DistanceToCell(const GridGeometry& geometry, Position position, Cell cell);

/// `distance_m` along `heading_rad`; negative is backward.
Position Ahead(Position from, double heading_rad, double distance_m);

/// Cells that a body of that radius overlaps along the straight path, nearest to `from` first.
std::vector<Cell> CellsSwept(const GridGeometry& geometry, Position from, Position to,
                             double radius_m = kBodyRadiusM);

/// Cells that the axis enters on the straight path, in order, without that of `from`; each is a
/// neighbour of the previous one. A path exactly through a corner goes via the row's neighbour.
std::vector<Cell> CellsEntered(const GridGeometry& geometry, Position from, Position to);

}  // namespace conav::sim
