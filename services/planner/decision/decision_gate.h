#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "common/runtime/clock.h"
#include "planner/decision/blackboard.h"
#include "planner/decision/method.h"

namespace conav::planner {

/// What is wrong with inputs that are well-formed one by one but do not belong together, for
/// example an operator's map of another building. The text names both sides and their values;
/// nothing when all fits. Needs state and map; the rest is looked at where it is there.
std::optional<std::string> Inconsistency(const RobotInputs& inputs);

/// Why a robot does not decide right now.
enum class BlockedReason {
  kNothing,        // decide
  kState,          // its first state has not arrived
  kCommand,        // its last command is still being executed
  kStopped,        // a person has stopped it
  kMap,            // the map of its newest step has not arrived
  kCamera,         // its camera's lens
  kBelief,         // the operator's map, at the revision that the guidance was drawn on
  kInconsistent,   // map, state, belief and guidance do not belong together (Inconsistency)
  kFirstGuidance,  // soft: the operator has not drawn a path yet
  kAnswer,         // soft: the operator has not answered the newest picture
  kNoLease,        // another planner process drives it, or none yet
  kLeaseLost,      // it shows the command of another planner that took it over
  kRelease,        // it has ended its last command, and this process gives it up
};

/// What the robot waits for, in words; lives for ever.
std::string_view Name(BlockedReason reason);

/// Decides when a robot has everything that its next decision needs, so that the same messages give
/// the same decisions in any order of arrival. Soft reasons end after a timeout: the robot goes on
/// alone. Threads: one worker's.
class DecisionGate {
 public:
  /// Of the soft reasons; by the clock whose time Check() gets.
  struct Timeouts {
    std::chrono::nanoseconds first_guidance;
    std::chrono::nanoseconds answer;
  };

  DecisionGate(AwaitedInput awaits, Timeouts timeouts) : awaits_(awaits), timeouts_(timeouts) {}

  /// `sent_sequence_number` and `lease_epoch` are those of the worker's last command.
  BlockedReason Check(const RobotInputs& inputs, std::uint64_t sent_sequence_number,
                      std::uint64_t lease_epoch, Clock::TimePoint now);

  /// True once after a soft reason ended by its timeout.
  bool TakeTimedOut() { return std::exchange(timed_out_, false); }

 private:
  BlockedReason ReasonNow(const RobotInputs& inputs, std::uint64_t sent_sequence_number,
                          std::uint64_t lease_epoch) const;
  void GiveUp(BlockedReason reason, const RobotInputs& inputs);

  AwaitedInput awaits_;
  Timeouts timeouts_;
  BlockedReason blocked_ =
      BlockedReason::kState;  // ignores kCommand: a step aside does not restart the wait
  Clock::TimePoint blocked_since_{};
  bool without_guidance_ = false;          // stopped waiting for the first guidance
  std::uint64_t unanswered_snapshot_ = 0;  // stopped waiting for an answer to this one
  bool timed_out_ = false;
};

}  // namespace conav::planner
