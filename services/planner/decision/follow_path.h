#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/runtime/clock.h"
#include "planner/decision/method.h"
#include "planner/decision/stand_off.h"

namespace conav::planner {

/// Goes along a guidance path cell by cell and remembers how far it has come, because a tour may
/// lead through one cell several times. A new path starts at its beginning, and so does the same
/// one given again.
class PathFollower {
 public:
  /// As StandOff.
  PathFollower(std::uint64_t seed, const Clock& clock) : stand_off_(seed, clock) {}

  /// The move to the cell that follows the robot's own on the path, or what stands in the way:
  /// kBlocked with the wall's cell, kNoGuidance when there is no path, nothing left of it, or the
  /// robot is beside it. Waits, without asking, while another robot stands on that cell; after half
  /// a second of that it steps out of the path at random.
  Decision Next(const Situation& situation);
  /// What is left of the path after the robot's cell; empty when it has no path, is beside it, or
  /// has no goals left.
  std::vector<Cell> Rest(const Situation& situation);

 private:
  /// Takes over a new path and finds the robot on it; false when it is not there.
  bool Locate(const Situation& situation);
  Decision FollowOrAsk(const Situation& situation);

  StandOff stand_off_;  // with another robot on the path
  std::vector<Cell> path_;
  std::uint64_t revision_ = 0;  // of the guidance that path_ was; likewise:
  SimTime stamp_;
  std::size_t position_ = 0;  // of the robot in path_
};

}  // namespace conav::planner
