#include <fmt/core.h>

#include <algorithm>

#include "planner/decision/robot_worker.h"

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
  if (inputs.belief && !AreAligned(inputs.belief->geometry(), inputs.map->geometry())) {
    return fmt::format("the operator's map has {}, the robot's {}",
                       Describe(inputs.belief->geometry()), Describe(inputs.map->geometry()));
  }
  if (state.grid.rows > 0 && !AreAligned(state.grid, inputs.map->geometry())) {
    return fmt::format("its state speaks of a map of {}, its map has {}", Describe(state.grid),
                       Describe(inputs.map->geometry()));
  }
  if (!inputs.misaligned.empty()) {
    return fmt::format("its map has {}, robot {} has another", Describe(state.grid),
                       inputs.misaligned);
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

std::string_view Name(BlockedReason reason) {
  constexpr std::string_view kNames[] = {// in the order of the reasons
                                         "nothing",
                                         "its state",
                                         "its command to end",
                                         "a person to resume it",
                                         "its map",
                                         "camera info",
                                         "the operator's map",
                                         "inputs that belong together",
                                         "the first guidance",
                                         "an answer to its picture",
                                         "a planner that shares its robots",
                                         "another planner to leave it",
                                         "another planner to take it over"};
  return kNames[static_cast<std::size_t>(reason)];
}

BlockedReason DecisionGate::Check(const RobotInputs& inputs, std::uint64_t sent_sequence_number,
                                  std::uint64_t lease_epoch, Clock::TimePoint now) {
  const BlockedReason reason = ReasonNow(inputs, sent_sequence_number, lease_epoch);
  if (reason == BlockedReason::kCommand || reason == BlockedReason::kMap) return reason;
  if (reason != blocked_) {
    blocked_ = reason;
    blocked_since_ = now;
  }
  const bool first = reason == BlockedReason::kFirstGuidance;
  const bool answer = reason == BlockedReason::kAnswer;
  const auto timeout = first ? timeouts_.first_guidance : timeouts_.answer;
  if ((!first && !answer) || now - blocked_since_ < timeout) return reason;
  without_guidance_ = true;
  if (answer) unanswered_snapshot_ = inputs.state->snapshots;
  timed_out_ = true;
  return Check(inputs, sent_sequence_number, lease_epoch, now);
}

BlockedReason DecisionGate::ReasonNow(const RobotInputs& inputs, std::uint64_t sent_sequence_number,
                                      std::uint64_t lease_epoch) const {
  if (inputs.lease.state == Lease::State::kNone) return BlockedReason::kNoLease;
  if (!inputs.state) return BlockedReason::kState;
  const RobotState& state = *inputs.state;
  if (lease_epoch != 0 && state.lease_epoch > lease_epoch) return BlockedReason::kLeaseLost;
  const bool running = state.command_outcome == CommandOutcome::kRunning;
  const bool releasing = inputs.lease.state == Lease::State::kReleasing;
  if (inputs.stopped() && (running || !releasing)) return BlockedReason::kStopped;
  // A newer number of this lease is somebody else's: the next command goes on from it.
  const bool taken_up =
      state.command_sequence_number >= sent_sequence_number && state.lease_epoch == lease_epoch;
  if (running) return BlockedReason::kCommand;
  if (sent_sequence_number != 0 && !taken_up) return BlockedReason::kCommand;
  if (releasing) return BlockedReason::kRelease;
  if (!inputs.map || inputs.map->stamp < state.map_stamp) return BlockedReason::kMap;
  if (awaits_ >= AwaitedInput::kAnswers && !inputs.lens) return BlockedReason::kCamera;
  if (awaits_ >= AwaitedInput::kBelief && !inputs.belief) return BlockedReason::kBelief;
  if (Inconsistency(inputs)) return BlockedReason::kInconsistent;
  const std::uint64_t answered = inputs.guidance ? inputs.guidance->answers_snapshot : 0;
  const bool answer_due = state.snapshots > std::max(answered, unanswered_snapshot_);
  if (awaits_ >= AwaitedInput::kAnswers && answer_due) return BlockedReason::kAnswer;
  if (awaits_ < AwaitedInput::kGuidance) return BlockedReason::kNothing;
  if (!inputs.guidance && !without_guidance_) return BlockedReason::kFirstGuidance;
  if (inputs.guidance && inputs.belief->revision < inputs.guidance->belief_revision)
    return BlockedReason::kBelief;
  return BlockedReason::kNothing;
}

}  // namespace conav::planner
