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
  bool driving = false;  // DecideMove: turned far enough to drive; hand it back in at the next step
};

/// A primitive gives up after this many control steps.
inline constexpr int kStuckSteps = 60;

/// Closed-loop motion primitives, one decision per 4 Hz step. Rolling and turning behave like
/// first-order systems, v' = (u v_max - friction - v) / tau, so a robot that is let go after one
/// step of T seconds under u comes to rest about tau v + u v_max T ahead. Solved for u, cut to [-1,
/// 1], that is the control that ends at the target. Pure functions; the constants are fitted to the
/// measured motion of the model (tests/unit/sim/physics/robot_world_test.cc).

/// Turn towards `target`, drive, settle. Arrived within 0.06 m and nearly at rest.
ControlDecision DecideMove(const RobotPose& pose, Position target, bool driving);
/// Arrived within 1 degree and nearly at rest.
ControlDecision DecideTurn(const RobotPose& pose, double heading_rad);
/// Brakes both motions.
ControlDecision DecideHalt(const RobotPose& pose);

/// Speeds that a low-level action asks for; backward and clockwise are negative.
struct DriveSpeeds {
  double forward_mps = 0.0;
  double turn_rps = 0.0;
};
/// The control that ends this step at `speeds`, as far as the motors can.
ControlDecision DecideDrive(const RobotPose& pose, const DriveSpeeds& speeds);
/// How far ahead (negative: back) the robot comes in a step of DecideDrive and the braking after it.
double DriveReach(const RobotPose& pose, const DriveSpeeds& speeds);

}  // namespace conav::sim
