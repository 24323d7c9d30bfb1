#include "planner/decision/decision_gate.h"

#include <algorithm>

#include "planner/decision/consistency.h"

namespace conav::planner {

std::string_view HoldName(Hold hold) {
  switch (hold) {
    case Hold::kNothing:
      return "nothing";
    case Hold::kState:
      return "its state";
    case Hold::kCommand:
      return "its command to end";
    case Hold::kStopped:
      return "whoever stopped it to let it go";
    case Hold::kMap:
      return "its map";
    case Hold::kCamera:
      return "camera info";
    case Hold::kBelief:
      return "the operator's map";
    case Hold::kInconsistent:
      return "inputs that belong together";
    case Hold::kFirstGuidance:
      return "the first guidance";
    case Hold::kAnswer:
      return "an answer to its picture";
    case Hold::kNoLease:
      return "a planner that shares its robots";
    case Hold::kLeaseLost:
      return "another planner to leave it";
    case Hold::kRelease:
      return "another planner to take it over";
  }
  return "?";
}

Hold DecisionGate::Check(const RobotInputs& inputs, std::uint64_t sent_sequence_number,
                         std::uint64_t lease_epoch, Clock::TimePoint now) {
  const Hold wanted = Want(inputs, sent_sequence_number, lease_epoch);
  if (wanted == Hold::kCommand || wanted == Hold::kMap) return wanted;
  if (wanted != hold_) {
    hold_ = wanted;
    hold_since_ = now;
  }
  const bool first = hold_ == Hold::kFirstGuidance && now - hold_since_ >= timeouts_.first_guidance;
  const bool answer = hold_ == Hold::kAnswer && now - hold_since_ >= timeouts_.answer;
  if (first || answer) {
    GiveUp(hold_, inputs);
    return Check(inputs, sent_sequence_number, lease_epoch, now);
  }
  return hold_;
}

Hold DecisionGate::Want(const RobotInputs& inputs, std::uint64_t sent_sequence_number,
                        std::uint64_t lease_epoch) const {
  if (inputs.lease.state == Lease::State::kNone) return Hold::kNoLease;
  if (!inputs.state) return Hold::kState;
  const RobotState& state = *inputs.state;
  if (lease_epoch != 0 && state.lease_epoch > lease_epoch) return Hold::kLeaseLost;
  const bool running = state.command_outcome == CommandOutcome::kRunning;
  const bool releasing = inputs.lease.state == Lease::State::kReleasing;
  if (inputs.stopped() && (running || !releasing)) return Hold::kStopped;
  const bool taken_up =
      state.command_sequence_number == sent_sequence_number && state.lease_epoch == lease_epoch;
  if (running) return Hold::kCommand;
  if (sent_sequence_number != 0 && !taken_up) return Hold::kCommand;
  if (releasing) return Hold::kRelease;
  if (!inputs.map || inputs.map->stamp < state.map_stamp) return Hold::kMap;
  if (awaits_ >= AwaitedInput::kAnswers && !inputs.lens) return Hold::kCamera;
  if (awaits_ >= AwaitedInput::kBelief && !inputs.belief) return Hold::kBelief;
  if (Inconsistency(inputs)) return Hold::kInconsistent;
  const std::uint64_t answered = inputs.guidance ? inputs.guidance->answers_snapshot : 0;
  const bool answer_due = state.snapshots > std::max(answered, unanswered_snapshot_);
  if (awaits_ >= AwaitedInput::kAnswers && answer_due) return Hold::kAnswer;
  if (awaits_ < AwaitedInput::kGuidance) return Hold::kNothing;
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
