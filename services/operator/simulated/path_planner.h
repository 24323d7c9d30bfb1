#pragma once

#include <limits>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "common/grid/grid.h"
#include "common/grid/map_accuracy.h"
#include "common/runtime/result.h"

namespace conav {
class ConfigReader;
}

namespace conav::operators {

inline constexpr double kUnreachable = std::numeric_limits<double>::infinity();

/// The cheapest way from one cell to every other (Dijkstra over 4-neighbours, or over 8).
class CostField {
 public:
  /// `entry_costs`: cost of a step into a cell, > 0; kUnreachable = never entered. With `diagonals` two
  /// steps around a corner cost 2^0.5 times the dearer one instead of both, as if they were one.
  /// Among ways of equal cost the one whose cells were settled first wins: cells are settled by cost,
  /// then row-major, neighbours taken north, east, south, west, then the diagonal ones.
  CostField(const Grid<double>& entry_costs, Cell source, bool diagonals = false);

  /// Sum of the entry costs from the source (not counted) to `cell` (counted).
  double CostTo(Cell cell) const { return cost_[cell]; }
  /// From the source to `cell`, both included, 4-connected. Requires a finite cost.
  std::vector<Cell> PathTo(Cell cell) const;

 private:
  Cell source_;
  Grid<double> cost_;
  Grid<Cell> previous_;
  Grid<Cell> corner_;  // entered on the way from there; the cell itself if there is none
};

struct PathPlannerParameters {
  /// Crossing a cell that the map shows as a wall costs this much more than a free one.
  double wall_crossing_cost = 10.0;
  /// "tour": a path over all goals that are left; "next_goal": only up to the tour's first
  /// goal; "away": to the cell of the map that is farthest from the goals, to mislead on purpose.
  std::string horizon = "tour";

  void Visit(ConfigReader& reader);
};

/// True where the operator takes the cell for a wall.
inline bool IsWall(const BeliefGrid& belief, Cell cell) { return belief[cell] >= kWallThreshold; }

inline constexpr double kShoreM = 4.0;
inline constexpr double kShoreCost = 1.0;
inline constexpr double kLandCost = 100.0;

/// The path that the simulated operator draws: on its own, possibly wrong map, the cheapest way
/// over the goals. A step costs 1, a step into a wall of the map 1 + wall_crossing_cost: a person
/// who doubts the map draws through a wall rather than around half of the world.
///
/// On a raster (IsRaster) the way may go diagonally, and a step into a free cell nearer than kShoreM to a wall of the map costs
/// up to kShoreCost more, the nearer the more: a person draws along the middle of a channel, and
/// through a narrow one nevertheless. A wall there costs kLandCost times as much: nobody takes a boat
/// over land unless the map has no other way.
///
/// The order of goals is the cheapest one for up to six goals, above that the nearest goal next.
/// All ties are broken by row and column, so that equal input gives equal paths.
/// Source: the partner model of mhri_intent (shortest path with 10 per violated wall).
class PathPlanner {
 public:
  explicit PathPlanner(PathPlannerParameters parameters, double cell_size_m = 2.0)
      : parameters_(std::move(parameters)), cell_size_m_(cell_size_m) {}

  /// 4-connected cells from `start` on, `start` included; never through `impassable` cells (of
  /// which the operator knows for certain) or the border. Goals that cannot be reached are left
  /// out; without any the path is {start}. Errors: kOutOfRange for a start or goal outside of the
  /// map.
  [[nodiscard]] Result<std::vector<Cell>> Plan(const BeliefGrid& belief,
                                               const std::set<Cell>& impassable, Cell start,
                                               std::span<const Cell> goals) const;

 private:
  Grid<double> EntryCosts(const BeliefGrid& belief, const std::set<Cell>& impassable) const;

  PathPlannerParameters parameters_;
  double cell_size_m_;
};

}  // namespace conav::operators
