#include "planner/decision/decision_gate.h"

#include <fmt/format.h>

#include <algorithm>

namespace conav::planner {
namespace {

std::optional<std::string> OutsideOf(const OccupancyGrid& map, const std::vector<Cell>& cells,
                                     std::string_view what) {
  const auto outside =
      std::find_if_not(cells.begin(), cells.end(), [&](Cell cell) { return map.Contains(cell); });
  if (outside == cells.end()) return std::nullopt;
  return fmt::format("{} {} is outside of the robot's {}x{} map", what, *outside, map.rows(),
                     map.columns());
}

template <class T>
std::optional<std::string> OtherSize(const OccupancyGrid& map, const Grid<T>& other,
                                     std::string_view what) {
  if (other.rows() == map.rows() && other.columns() == map.columns()) return std::nullopt;
  return fmt::format("{} has {}x{} cells, the robot's has {}x{}", what, other.rows(),
                     other.columns(), map.rows(), map.columns());
}

}  // namespace

std::optional<std::string> Inconsistency(const RobotInputs& inputs) {
  const RobotState& state = *inputs.state;
  const OccupancyGrid& map = inputs.map->cells;
  if (inputs.belief) {
    const BeliefGrid& belief = inputs.belief->wall_probability;
    if (auto text = OtherSize(map, belief, "the operator's map")) return text;
  }
  if (inputs.truth) {
    if (auto text = OtherSize(map, *inputs.truth, "the true map")) return text;
  }
  if (auto text = OutsideOf(map, {state.cell}, "its cell")) return text;
  if (auto text = OutsideOf(map, state.path, "cell of its path")) return text;
  if (auto text = OutsideOf(map, state.goals_left, "goal")) return text;
  if (inputs.guidance) {
    if (auto text = OutsideOf(map, inputs.guidance->path, "cell of its guidance")) return text;
  }
  if (map[state.cell] == Occupancy::kOccupied) {
    return fmt::format("its cell {} is a wall on its own map", state.cell);
  }
  return std::nullopt;
}

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
