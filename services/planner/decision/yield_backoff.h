#pragma once

#include <chrono>
#include <cstdint>

#include "common/runtime/clock.h"
#include "common/runtime/random.h"

namespace conav::planner {

/// Random waits of a robot that keeps making room, so that robots which step to and fro for each
/// other fall out of step: after the k-th time without getting on, 0 to 2^k - 2 slots, k at most 4.
/// The first time it waits for nothing. Getting on is kOwnMoves moves of its own in a row.
///
/// Binary exponential back-off: Metcalfe and Boggs, "Ethernet: Distributed Packet Switching for
/// Local Computer Networks", CACM 1976.
class YieldBackoff {
 public:
  static constexpr int kOwnMoves = 4;

  /// `slot`: wall time.
  YieldBackoff(std::uint64_t seed, std::chrono::nanoseconds slot) : random_(seed), slot_(slot) {}

  /// The robot steps aside.
  void MakesRoom(Clock::TimePoint now) {
    own_moves_ = 0;
    times_ = times_ < kMostTimes ? times_ + 1 : kMostTimes;
    until_ = now + random_.Uniform(0, (std::int64_t{1} << times_) - 2) * slot_;
  }
  /// It goes on its own way.
  void Moves() {
    if (++own_moves_ >= kOwnMoves) times_ = 0;
  }
  /// When it may go on its own way again.
  Clock::TimePoint until() const { return until_; }

 private:
  static constexpr int kMostTimes = 4;

  Random random_;
  std::chrono::nanoseconds slot_;
  Clock::TimePoint until_{};
  int times_ = 0;
  int own_moves_ = 0;
};

}  // namespace conav::planner
