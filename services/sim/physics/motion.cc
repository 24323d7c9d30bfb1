#include "sim/physics/motion.h"

#include <algorithm>
#include <cmath>

#include "sim/physics/world_model.h"

namespace conav::sim {
namespace {

constexpr double kDegree = 0.017453292519943295;

/// v' = (u max_rate - friction sign(v) - v) / lag_s, rates in m/s or rad/s.
struct Axis {
  double max_rate;  // at full control, without friction
  double lag_s;
  double friction;
  double good_enough;  // let go when coasting ends this near
};
constexpr Axis kRoll{2.0, 0.168, 0.0, 0.0};
/// Motor 30 N m, damping 20 N m s, inertia 1.17 kg m^2, torsional friction 0.02 m * 216 N.
constexpr Axis kSteer{30.0 / 20.0, 1.17 / 20.0, 4.32 / 20.0, 0.4 * kDegree};

constexpr double kArrivedDistanceM = 0.06;
constexpr double kNearM = 0.3;  // from here on the heading is held: the bearing becomes noise
constexpr double kArrivedAngleRad = 1.0 * kDegree;
constexpr double kDriveAngleRad = 2.0 * kDegree;
constexpr double kLostAngleRad = 25.0 * kDegree;
constexpr double kRestMps = 0.04;
constexpr double kRestRps = 6.0 * kDegree;

/// How far the motion goes on when it is let go.
double CoastingDistance(const Axis& axis, double rate) {
  const double speed = std::abs(rate);
  const double lost = axis.friction > 0.0 ? axis.friction * std::log1p(speed / axis.friction) : 0.0;
  return std::copysign(axis.lag_s * (speed - lost), rate);
}

/// The control that ends `distance` ahead when the robot coasts after this step.
double Approach(const Axis& axis, double distance, double rate) {
  if (std::abs(distance - CoastingDistance(axis, rate)) < axis.good_enough) return 0.0;
  const double needed = distance - axis.lag_s * rate;
  const double sign = needed < 0.0 ? -1.0 : 1.0;
  double net_rate = std::abs(needed) / kControlStepS;
  if (axis.friction > 0.0) {
    // Friction takes lag f ln(1 + r / f) off the coasting; three rounds of fixed point settle it.
    for (int round = 0; round < 3; ++round) {
      const double lost = axis.lag_s * axis.friction * std::log1p(net_rate / axis.friction);
      net_rate = (std::abs(needed) + lost) / kControlStepS;
    }
  }
  return std::clamp(sign * (net_rate + axis.friction) / axis.max_rate, -1.0, 1.0);
}

/// Share of a rate that is left after a step without control.
double Kept(const Axis& axis) { return std::exp(-kControlStepS / axis.lag_s); }

/// The control that ends this step at `target`, in the direction of which friction works against
/// it.
double Reach(const Axis& axis, double rate, double target) {
  const double steady = (target - rate * Kept(axis)) / (1.0 - Kept(axis));
  const double friction = target == 0.0 ? 0.0 : std::copysign(axis.friction, target);
  return std::clamp((steady + friction) / axis.max_rate, -1.0, 1.0);
}

/// The control that ends this step at rest; friction alone stops the turning.
double Brake(const Axis& axis, double rate) {
  return axis.friction > 0.0 ? 0.0 : Reach(axis, rate, 0.0);
}

/// How far an axis without friction comes in a step that ends it at `target`, as far as it can, and
/// what its rate is then.
struct Travel {
  double distance;
  double rate;
};
Travel TravelOf(const Axis& axis, double rate, double target) {
  const double steady = axis.max_rate * Reach(axis, rate, target);
  const double lost = 1.0 - Kept(axis);
  return {steady * kControlStepS + (rate - steady) * axis.lag_s * lost,
          steady * lost + rate * Kept(axis)};
}

bool AtRest(const RobotPose& pose) {
  return std::abs(pose.speed_mps) < kRestMps && std::abs(pose.yaw_rate_rps) < kRestRps;
}

}  // namespace

ControlDecision DecideMove(const RobotPose& pose, Position target, bool driving) {
  const double dx = target.x_m - pose.position.x_m;
  const double dy = target.y_m - pose.position.y_m;
  const double distance = std::hypot(dx, dy);
  ControlDecision decision;
  if (distance < kArrivedDistanceM && AtRest(pose)) {
    decision.arrived = true;
    return decision;
  }
  const double bearing_error = WrapAngle(std::atan2(dy, dx) - pose.heading_rad);
  const double ahead = distance * std::cos(bearing_error);
  const double aside = distance * std::sin(bearing_error);
  const bool near = distance < kNearM;
  const double limit = driving ? kLostAngleRad : kDriveAngleRad;
  decision.driving = near ? std::abs(aside) < kArrivedDistanceM : std::abs(bearing_error) < limit;
  if (near && decision.driving) {
    decision.controls = {Approach(kRoll, ahead, pose.speed_mps), Brake(kSteer, pose.yaw_rate_rps)};
    return decision;
  }
  const double turn = Approach(kSteer, bearing_error, pose.yaw_rate_rps);
  const double roll =
      decision.driving ? Approach(kRoll, ahead, pose.speed_mps) : Brake(kRoll, pose.speed_mps);
  decision.controls = {roll, turn};
  return decision;
}

ControlDecision DecideTurn(const RobotPose& pose, double heading_rad) {
  const double error = WrapAngle(heading_rad - pose.heading_rad);
  ControlDecision decision;
  decision.arrived = std::abs(error) < kArrivedAngleRad && AtRest(pose);
  if (decision.arrived) return decision;
  decision.controls = {Brake(kRoll, pose.speed_mps), Approach(kSteer, error, pose.yaw_rate_rps)};
  return decision;
}

ControlDecision DecideHalt(const RobotPose& pose) {
  ControlDecision decision;
  decision.arrived = AtRest(pose);
  if (decision.arrived) return decision;
  decision.controls = {Brake(kRoll, pose.speed_mps), Brake(kSteer, pose.yaw_rate_rps)};
  return decision;
}

ControlDecision DecideDrive(const RobotPose& pose, const DriveSpeeds& speeds) {
  const double turn = speeds.turn_rps == 0.0 ? Brake(kSteer, pose.yaw_rate_rps)
                                             : Reach(kSteer, pose.yaw_rate_rps, speeds.turn_rps);
  return {{Reach(kRoll, pose.speed_mps, speeds.forward_mps), turn}};
}

double DriveReach(const RobotPose& pose, const DriveSpeeds& speeds) {
  const Travel step = TravelOf(kRoll, pose.speed_mps, speeds.forward_mps);
  return step.distance + TravelOf(kRoll, step.rate, 0.0).distance;
}

}  // namespace conav::sim
