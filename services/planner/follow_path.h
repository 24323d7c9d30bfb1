#pragma once

#include <cstddef>
#include <vector>

#include "planner/method.h"

namespace conav::planner {

/// Goes along a guidance path cell by cell and remembers how far it has come, because a tour may
/// lead through one cell several times. A new path starts at its beginning.
class PathFollower {
 public:
  /// The move to the cell that follows the robot's own on the path, or what stands in the way:
  /// kBlocked with the wall's cell, kNoGuidance when there is no path, nothing left of it, or the
  /// robot is beside it. Waits, without asking, while another robot stands on that cell.
  Decision Next(const Situation& situation);
  /// What is left of the path after the place where the robot was last.
  std::vector<Cell> Rest() const;

 private:
  std::vector<Cell> path_;
  std::size_t position_ = 0;  // in path_: where the robot was last
};

/// The move along `plan`, decided without a search; `plan` is not empty.
Decision MoveAlong(std::vector<Cell> plan);

}  // namespace conav::planner
