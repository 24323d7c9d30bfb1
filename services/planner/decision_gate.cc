#include "planner/decision_gate.h"

#include <algorithm>

namespace conav::planner {

std::string_view HoldName(Hold hold) {
  switch (hold) {
    case Hold::kNothing:
      return "nothing";
    case Hold::kState:
      return "state";
    case Hold::kCommand:
      return "command";
    case Hold::kMap:
      return "map";
    case Hold::kBelief:
      return "belief";
    case Hold::kFirstGuidance:
      return "first guidance";
    case Hold::kAnswer:
      return "answer";
    case Hold::kLeaseLost:
      return "lease lost";
  }
  return "?";
}

Hold DecisionGate::Check(const RobotInputs& inputs, std::uint64_t sent_sequence_number,
                         std::uint64_t lease_epoch, Clock::TimePoint now) {
  const Hold wanted = Want(inputs, sent_sequence_number, lease_epoch);
  if (wanted != hold_) {
    hold_ = wanted;
    hold_since_ = now;
  }
  const bool first =
      hold_ == Hold::kFirstGuidance && now - hold_since_ >= options_.first_guidance_timeout;
  const bool answer = hold_ == Hold::kAnswer && now - hold_since_ >= options_.answer_timeout;
  if (first || answer) {
    GiveUp(hold_, inputs);
    return Check(inputs, sent_sequence_number, lease_epoch, now);
  }
  return hold_;
}

Hold DecisionGate::Want(const RobotInputs& inputs, std::uint64_t sent_sequence_number,
                        std::uint64_t lease_epoch) const {
  if (!inputs.state) return Hold::kState;
  const RobotState& state = *inputs.state;
  if (lease_epoch != 0 && state.lease_epoch > lease_epoch) return Hold::kLeaseLost;
  const bool taken_up = state.command_sequence_number == sent_sequence_number;
  if (state.command_outcome == CommandOutcome::kRunning) return Hold::kCommand;
  if (sent_sequence_number != 0 && !taken_up) return Hold::kCommand;
  if (!inputs.map || inputs.map->stamp < state.map_stamp) return Hold::kMap;
  if (!inputs.belief) return Hold::kBelief;
  const std::uint64_t answered = inputs.guidance ? inputs.guidance->answers_snapshot : 0;
  const bool answer_due = state.snapshots > std::max(answered, unanswered_snapshot_);
  if (options_.pictures_are_answered && answer_due) return Hold::kAnswer;
  if (!inputs.guidance && !without_guidance_) return Hold::kFirstGuidance;
  if (inputs.guidance && inputs.belief->revision < inputs.guidance->belief_revision)
    return Hold::kBelief;
  return Hold::kNothing;
}

void DecisionGate::GiveUp(Hold hold, const RobotInputs& inputs) {
  if (hold == Hold::kFirstGuidance) without_guidance_ = true;
  if (hold == Hold::kAnswer) {
    unanswered_snapshot_ = inputs.state->snapshots;
    without_guidance_ = true;
  }
  timed_out_ = true;
}

}  // namespace conav::planner
