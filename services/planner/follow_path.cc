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

Decision PathFollower::Next(const Situation& situation) {
  const Cell here = situation.state.cell;
  if (!situation.guidance) return Ask(AttentionReason::kNoGuidance, here);
  if (path_ != situation.guidance->path) {
    path_ = situation.guidance->path;
    position_ = 0;
  }
  const auto from = path_.begin() + static_cast<std::ptrdiff_t>(position_);
  const auto at = std::find(from, path_.end(), here);
  if (at == path_.end() || at + 1 == path_.end()) return Ask(AttentionReason::kNoGuidance, here);
  position_ = static_cast<std::size_t>(at - path_.begin());
  const Cell next = *(at + 1);
  if (KnownWall(situation, next)) return Ask(AttentionReason::kBlocked, next);
  const bool taken = std::any_of(situation.neighbours.begin(), situation.neighbours.end(),
                                 [&](const Neighbour& other) { return other.cell == next; });
  if (taken) return {};
  return MoveAlong({at + 1, path_.end()});
}

std::vector<Cell> PathFollower::Rest() const {
  if (position_ + 1 >= path_.size()) return {};
  return {path_.begin() + static_cast<std::ptrdiff_t>(position_) + 1, path_.end()};
}

}  // namespace conav::planner
