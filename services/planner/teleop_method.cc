#include "planner/teleop_method.h"

#include "planner/follow_path.h"

namespace conav::planner {

Decision TeleopMethod::Decide(const Situation& situation) {
  if (situation.state.goals_left.empty()) return {};
  const bool fresh = situation.guidance && situation.guidance->revision != done_revision_;
  if (!fresh) {
    Decision decision;
    decision.attention = AttentionReason::kNoGuidance;
    decision.attention_cell = situation.state.cell;
    return decision;
  }
  Decision decision = PathFollower().Next(situation);
  if (decision.action || decision.attention) done_revision_ = situation.guidance->revision;
  return decision;
}

}  // namespace conav::planner
