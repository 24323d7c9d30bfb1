#include "planner/decision/follow_path.h"

#include <algorithm>

#include "planner/decision/known_wall.h"
#include "planner/decision/traffic.h"

namespace conav::planner {
namespace {

Decision Ask(AttentionReason reason, Cell cell) {
  Decision decision;
  decision.attention = reason;
  decision.attention_cell = cell;
  return decision;
}

}  // namespace

bool PathFollower::Locate(const Situation& situation) {
  if (!situation.guidance) return false;
  const Guidance& guidance = *situation.guidance;
  if (path_ != guidance.path) stand_off_.End();
  // A goal pose keeps the revision, not the stamp.
  if (path_ != guidance.path || revision_ != guidance.revision || stamp_ != guidance.stamp) {
    path_ = guidance.path;
    revision_ = guidance.revision;
    stamp_ = guidance.stamp;
    position_ = 0;
  }
  const auto from = path_.begin() + static_cast<std::ptrdiff_t>(position_);
  const auto at = std::find(from, path_.end(), situation.state.cell);
  if (at == path_.end()) return false;
  position_ = static_cast<std::size_t>(at - path_.begin());
  return true;
}

std::vector<Cell> PathFollower::Rest(const Situation& situation) {
  if (situation.state.goals_left.empty() || !Locate(situation)) return {};
  return {path_.begin() + static_cast<std::ptrdiff_t>(position_) + 1, path_.end()};
}

Decision PathFollower::Next(const Situation& situation) {
  Decision decision = FollowOrAsk(situation);
  if (decision.action || decision.attention) {
    stand_off_.End();
    return decision;
  }
  return stand_off_.WaitOrStepOut(situation);
}

Decision PathFollower::FollowOrAsk(const Situation& situation) {
  std::vector<Cell> rest = Rest(situation);
  if (rest.empty()) return Ask(AttentionReason::kNoGuidance, situation.state.cell);
  const Cell next = rest.front();
  if (IsKnownWall(situation.map.cells, next)) return Ask(AttentionReason::kBlocked, next);
  if (IsTaken(situation, next) || WaitsFor(situation, rest) != nullptr) return {};
  return MoveAlong(std::move(rest));
}

}  // namespace conav::planner
