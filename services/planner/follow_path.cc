#include "planner/follow_path.h"

#include <algorithm>

namespace conav::planner {
namespace {

Decision Ask(AttentionReason reason, Cell cell) {
  Decision decision;
  decision.attention = reason;
  decision.attention_cell = cell;
  return decision;
}

bool KnownWall(const Situation& situation, Cell cell) {
  const OccupancyGrid& map = situation.map.cells;
  return !map.Contains(cell) || map[cell] == Occupancy::kOccupied;
}

}  // namespace

Decision MoveAlong(std::vector<Cell> plan) {
  Decision decision;
  decision.action = Action{CommandKind::kMove, plan.front(), 0.0};
  decision.report.actions.push_back({.target = plan.front(), .visits = 1});
  decision.report.chosen = 0;
  decision.plan = std::move(plan);
  return decision;
}

Decision FollowPath(const Situation& situation) {
  const Cell here = situation.state.cell;
  if (!situation.guidance) return Ask(AttentionReason::kNoGuidance, here);
  const std::vector<Cell>& path = situation.guidance->path;
  const auto at = std::find(path.rbegin(), path.rend(), here);
  if (at == path.rend() || at == path.rbegin()) return Ask(AttentionReason::kNoGuidance, here);
  const auto next = at.base();  // the cell after `here`
  if (KnownWall(situation, *next)) return Ask(AttentionReason::kBlocked, *next);
  const bool taken = std::any_of(situation.neighbours.begin(), situation.neighbours.end(),
                                 [&](const Neighbour& other) { return other.cell == *next; });
  if (taken) return {};
  return MoveAlong({next, path.end()});
}

}  // namespace conav::planner
