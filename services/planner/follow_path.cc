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

SearchReport ReportOf(const Action& action) {
  SearchReport report;
  report.actions.push_back({.kind = action.kind, .target = action.target, .visits = 1});
  report.chosen = 0;
  return report;
}

Decision FollowPath(const Situation& situation) {
  const Cell here = situation.state.cell;
  if (!situation.guidance) return Ask(AttentionReason::kNoGuidance, here);
  const std::vector<Cell>& path = situation.guidance->path;
  const auto at = std::find(path.rbegin(), path.rend(), here);
  if (at == path.rend() || at == path.rbegin()) return Ask(AttentionReason::kNoGuidance, here);
  const auto next = at.base();  // the cell after `here`
  if (KnownWall(situation, *next)) return Ask(AttentionReason::kBlocked, *next);
  Decision decision;
  decision.way.assign(next, path.end());
  const bool taken = std::any_of(situation.neighbours.begin(), situation.neighbours.end(),
                                 [&](const Neighbour& other) { return other.cell == *next; });
  if (taken) return decision;
  decision.action = Action{CommandKind::kMove, *next, 0.0};
  decision.report = ReportOf(*decision.action);
  return decision;
}

}  // namespace conav::planner
