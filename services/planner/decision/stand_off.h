#pragma once

#include <cstdint>
#include <optional>

#include "common/runtime/clock.h"
#include "common/runtime/random.h"
#include "planner/decision/method.h"

namespace conav::planner {

/// What a robot does while another one stands in its way: waits for kPatience, then steps out of
/// the way at random, so that two that wait for each other do not do so for ever.
class StandOff {
 public:
  /// `clock` outlives this.
  StandOff(std::uint64_t seed, const Clock& clock) : random_(seed), clock_(clock) {}

  /// The way is taken: wait (no action), or the random step.
  Decision WaitOrStepOut(const Situation& situation);
  /// The way is free, or another one.
  void End() { since_.reset(); }

 private:
  Random random_;
  const Clock& clock_;
  std::optional<Clock::TimePoint> since_;
};

}  // namespace conav::planner
