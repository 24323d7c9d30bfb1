#pragma once

#include <optional>

#include "common/protocol/robot.h"
#include "common/protocol/supervision.h"
#include "common/runtime/result.h"

namespace conav::planner {

/// Turns a goal pose (RViz "2D Goal Pose", map frame) into guidance: the shortest path from the
/// robot's cell to the goal's, over cells that neither the robot knows as walls nor, where the
/// robot knows nothing, the operator takes for walls. Valid for ten minutes of simulation time; it
/// keeps the revision of `current`, so that the operator's next path replaces it. Errors:
/// kOutOfRange (goal outside of the map), kNotFound (no path).
Result<Guidance> GuidanceTowards(Position goal, const RobotState& state, const MapUpdate& map,
                                 const Belief& belief, const std::optional<Guidance>& current);

}  // namespace conav::planner
