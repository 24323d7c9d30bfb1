#pragma once

#include <span>

#include "common/grid/geometry.h"
#include "common/runtime/result.h"

namespace conav::robot {

/// A place with a heading, or the motion of the plane that carries the origin there: of a robot in a
/// frame, or of one frame in another. `a * b` is b seen from a's parent: map_from_odom *
/// odom_from_base is the base in the map.
struct Pose {
  Position position;
  double heading_rad = 0.0;
  bool operator==(const Pose&) const = default;
};

Position operator*(const Pose& frame, Position place);
Pose operator*(const Pose& frame, const Pose& pose);
Pose Inverse(const Pose& pose);

/// The same point on the robot's own map and on the operator's plan, both in metres.
struct PointPair {
  Position robot;
  Position plan;
};

/// Where the robot's map lies on the plan.
struct Alignment {
  Pose plan_from_robot;
  double residual_m = 0.0;  // of the pair that fits worst
};

/// The rigid motion that brings the points of three or more pairs closest together in the sense of least
/// squares. Source: Kabsch, "A solution for the best rotation to relate two sets of vectors", 1976,
/// which in the plane is one arc tangent. Errors: kInvalidArgument: fewer than three pairs, points that
/// coincide or are no numbers; a residual above `most_residual_m` names the worst pair.
Result<Alignment> AlignByPairs(std::span<const PointPair> pairs, double most_residual_m);

}  // namespace conav::robot
