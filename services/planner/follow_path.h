#pragma once

#include "planner/method.h"

namespace conav::planner {

/// The move to the cell that follows the robot's own on the guidance path (its last occurrence
/// there), or what stands in the way: kBlocked with the wall's cell, kNoGuidance when there is no
/// path or nothing left of it. Waits, without asking, while another robot stands on that cell.
Decision FollowPath(const Situation& situation);

/// The move along `plan`, decided without a search; `plan` is not empty.
Decision MoveAlong(std::vector<Cell> plan);

}  // namespace conav::planner
