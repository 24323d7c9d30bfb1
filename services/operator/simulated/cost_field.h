#pragma once

#include <limits>
#include <vector>

#include "common/grid/grid.h"

namespace conav::operators {

inline constexpr double kUnreachable = std::numeric_limits<double>::infinity();

/// The cheapest way from one cell to every other (Dijkstra over 4-neighbours).
class CostField {
 public:
  /// `entry_costs`: cost of a step into a cell, > 0; kUnreachable = never entered. Among ways of
  /// equal cost the one whose cells were settled first wins: cells are settled by cost, then
  /// row-major, neighbours taken north, east, south, west.
  CostField(const Grid<double>& entry_costs, Cell source);

  /// Sum of the entry costs from the source (not counted) to `cell` (counted).
  double CostTo(Cell cell) const { return cost_[cell]; }
  /// From the source to `cell`, both included. Requires a finite cost.
  std::vector<Cell> PathTo(Cell cell) const;

 private:
  Cell source_;
  Grid<double> cost_;
  Grid<Cell> previous_;
};

}  // namespace conav::operators
