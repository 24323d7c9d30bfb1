#pragma once

#include <cstdint>

#include "common/grid/geometry.h"

namespace conav::sim {

enum class MotionStatus : std::uint8_t {
  kIdle,     // nothing commanded yet
  kRunning,  // the primitive is under way
  kArrived,  // done: in place and (nearly) at rest
  kStuck,    // not done after kStuckSteps: something is in the way; the robot brakes
};

/// Map frame, metres and radians.
struct RobotPose {
  Position position;
  double heading_rad = 0.0;   // (-pi, pi]
  double speed_mps = 0.0;     // along the heading, forward positive
  double yaw_rate_rps = 0.0;  // counter-clockwise positive
};

/// Continuous controls in [-1, 1], held for one 4 Hz step.
struct Controls {
  double forward = 0.0;
  double turn_left = 0.0;
};

struct ControlDecision {
  Controls controls;
  bool arrived = false;
};

/// A primitive gives up after this many control steps.
inline constexpr int kStuckSteps = 60;

/// Closed-loop motion primitives, one decision per 4 Hz step. Rolling and turning are first-order
/// systems (v' = (u v_max - v) / tau), for which u = (distance - tau v) / (v_max T) is the control
/// that leaves the robot at the target after coasting; it is cut to [-1, 1].
/// Pure functions; constants in motion.cc are fitted to paper-notes' measured motion.
ControlDecision DecideMove(const RobotPose& pose, Position target, bool driving);
ControlDecision DecideTurn(const RobotPose& pose, double heading_rad);
ControlDecision DecideHalt(const RobotPose& pose);

}  // namespace conav::sim
