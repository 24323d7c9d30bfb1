#include "sim/physics/motion.h"

#include <algorithm>
#include <cmath>

#include "sim/physics/world_model.h"

namespace conav::sim {
namespace {

constexpr double kDegree = 0.017453292519943295;

/// A first-order motion v' = (u max_rate - v) / lag_s.
struct Axis {
  double max_rate;  // m/s or rad/s at full control
  double lag_s;
};
constexpr Axis kRoll{2.0, 0.168};
constexpr Axis kSteer{73.6 * kDegree, 0.06};

constexpr double kArrivedDistanceM = 0.06;
constexpr double kNearM = 0.3;  // from here on the heading is held: the bearing becomes noise
constexpr double kArrivedAngleRad = 0.5 * kDegree;
constexpr double kDriveAngleRad = 2.0 * kDegree;
constexpr double kLostAngleRad = 25.0 * kDegree;
constexpr double kRestMps = 0.04;
constexpr double kRestRps = 3.0 * kDegree;

/// The control that ends `distance` ahead when the robot coasts after this step.
double Approach(const Axis& axis, double distance, double rate) {
  return std::clamp((distance - axis.lag_s * rate) / (axis.max_rate * kControlStepS), -1.0, 1.0);
}

/// The control that ends this step at rest.
double Brake(const Axis& axis, double rate) {
  const double kept = std::exp(-kControlStepS / axis.lag_s);
  return std::clamp(-rate * kept / (axis.max_rate * (1.0 - kept)), -1.0, 1.0);
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

}  // namespace conav::sim
