#include "planner/decision/teleop_method.h"

namespace conav::planner {

Decision TeleopMethod::Decide(const Situation& situation, const StopToken&) {
  if (situation.state.goals_left.empty()) return {};
  if (!situation.guidance || IsDone(*situation.guidance)) {
    Decision decision;
    decision.attention = AttentionReason::kNoGuidance;
    decision.attention_cell = situation.state.cell;
    return decision;
  }
  Decision decision = follower_.Next(situation);
  if (decision.action || decision.attention) {
    done_revision_ = situation.guidance->revision;
    done_stamp_ = situation.guidance->stamp;
  }
  return decision;
}

std::vector<Cell> TeleopMethod::WayFor(const Situation& situation) {
  return follower_.Rest(situation);
}

bool TeleopMethod::IsDone(const Guidance& order) const {
  return order.revision == done_revision_ && order.stamp == done_stamp_;
}

}  // namespace conav::planner
