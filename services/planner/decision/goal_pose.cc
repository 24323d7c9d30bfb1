#include "planner/decision/goal_pose.h"

#include <algorithm>

#include "planner/decision/way_to_nearest.h"

namespace conav::planner {
namespace {

constexpr std::chrono::minutes kValidFor{10};

bool Passable(const MapUpdate& map, const Belief& belief, Cell cell) {
  if (map.cells[cell] == Occupancy::kUnknown) return belief.wall_probability[cell] < 0.5F;
  return map.cells[cell] == Occupancy::kFree;
}

/// With `from` as its first cell; empty when there is no path.
std::vector<Cell> ShortestPath(const MapUpdate& map, const Belief& belief, Cell from, Cell to) {
  if (from == to) return {from};
  std::vector<Cell> path = WayToNearest(
      map.cells, from, [&](Cell cell) { return Passable(map, belief, cell); },
      [&](Cell cell) { return cell == to; });
  if (!path.empty()) path.insert(path.begin(), from);
  return path;
}

}  // namespace

Result<Guidance> GuidanceTowards(Position goal, const RobotState& state, const MapUpdate& map,
                                 const Belief& belief, const std::optional<Guidance>& current) {
  const GridGeometry geometry{map.cells.rows(), map.cells.columns(), map.cell_size_m};
  const Cell cell = geometry.PositionToCell(goal);
  if (!map.cells.Contains(cell)) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("goal pose ({:.2f}, {:.2f}) m lies in cell {}, outside of "
                            "the {}x{} map",
                            goal.x_m, goal.y_m, cell, map.cells.rows(), map.cells.columns()));
  }
  Guidance guidance = current.value_or(Guidance{});
  guidance.path = ShortestPath(map, belief, state.cell, cell);
  if (guidance.path.empty()) {
    return Fail(ErrorCode::kNotFound,
                fmt::format("no path from {} to the goal pose's cell {}", state.cell, cell));
  }
  guidance.stamp = state.stamp;
  guidance.world = state.world;
  guidance.robot = state.robot;
  guidance.given_by = "goal_pose";
  guidance.belief_revision = std::min(guidance.belief_revision, belief.revision);
  guidance.valid_until = state.stamp + kValidFor;
  return guidance;
}

}  // namespace conav::planner
