#include "robot/driver/mover.h"

#include <algorithm>
#include <cmath>

namespace conav::robot {
namespace {

constexpr double kTurnGain = 2.0;       // 1/s
constexpr double kLeastTurnRps = 0.15;  // slower, many bases do not turn at all
constexpr double kLeastSpeedMps = 0.05;
constexpr double kTurnFirstRad = 0.5;  // looks elsewhere by more: turns before it drives
constexpr double kNearestM = 0.04;
constexpr double kLongestStepS = 0.2;
constexpr int kRests = 10;
/// A robot that moves by less in so long stands.
constexpr double kStandsM = 0.02;
constexpr double kStandsRad = 0.02;
constexpr auto kStandsFor = std::chrono::milliseconds(400);

double Bearing(Position from, Position to) {
  return std::atan2(to.y_m - from.y_m, to.x_m - from.x_m);
}

}  // namespace

bool IsAt(const Target& target, const Pose& at, double heading_tolerance_rad) {
  if (Distance(at.position, target.place) > target.tolerance_m) return false;
  return !target.heading_rad ||
         std::abs(WrapAngle(*target.heading_rad - at.heading_rad)) <= heading_tolerance_rad;
}

Pose GoalOf(const Target& target, const Pose& at) {
  const bool is_there = Distance(at.position, target.place) <= target.tolerance_m;
  const double as_it_comes = is_there ? at.heading_rad : Bearing(at.position, target.place);
  return {target.place, target.heading_rad.value_or(as_it_comes)};
}

void PursuitMover::Begin(const Target& target, const Pose&) {
  target_ = target;
  is_there_ = false;
}

double PursuitMover::TurnBy(double error_rad) const {
  const double turn = std::clamp(kTurnGain * error_rad, -options_.turn_rps, options_.turn_rps);
  const double least = std::min(kLeastTurnRps, options_.turn_rps);
  return std::abs(turn) < least ? std::copysign(least, error_rad) : turn;
}

Mover::Progress PursuitMover::Step(const Pose& at, Clock::TimePoint now) {
  const double step_s =
      stepped_at_ ? std::chrono::duration<double>(now - *stepped_at_).count() : 0.0;
  stepped_at_ = now;
  const double left_m = Distance(at.position, target_.place);
  // It aims at the middle: where it stands in the end is a little further on or back.
  const double near_m =
      target_.last ? std::max(kNearestM, target_.tolerance_m / 2.0) : target_.tolerance_m;
  is_there_ = left_m <= (is_there_ ? target_.tolerance_m : near_m);
  if (is_there_) {
    const double error_rad =
        target_.heading_rad ? WrapAngle(*target_.heading_rad - at.heading_rad) : 0.0;
    const bool turned = std::abs(error_rad) <= options_.heading_tolerance_rad;
    if (!turned) {
      Publish({0.0, TurnBy(error_rad)});
      return {};
    }
    if (target_.last) Publish({});
    return {State::kArrived, ""};
  }
  const double error_rad = WrapAngle(Bearing(at.position, target_.place) - at.heading_rad);
  if (std::abs(error_rad) > kTurnFirstRad) {
    Publish({0.0, TurnBy(error_rad)});
    return {};
  }
  const double most_gain = options_.acceleration_mps2 * std::min(step_s, kLongestStepS);
  double speed = std::min(options_.speed_mps, velocity_.forward_mps + most_gain);
  if (target_.last) speed = std::min(speed, std::sqrt(2.0 * options_.acceleration_mps2 * left_m));
  speed = std::max(speed * std::cos(error_rad), std::min(kLeastSpeedMps, options_.speed_mps));
  Publish({speed, std::clamp(kTurnGain * error_rad, -options_.turn_rps, options_.turn_rps)});
  return {};
}

void PursuitMover::Cancel(const Pose&) {
  Publish({});
  stepped_at_.reset();
}

void PursuitMover::Rest() {
  // A lost message must not leave it driving; for longer, others may drive it.
  if (rests_ < kRests) Publish({});
}

bool PursuitMover::Drive(DriveAction action) {
  switch (action) {
    case DriveAction::kStop:
      Publish({});
      break;
    case DriveAction::kForward:
      Publish({options_.speed_mps, 0.0});
      break;
    case DriveAction::kBackward:
      Publish({-options_.speed_mps / 2.0, 0.0});
      break;
    case DriveAction::kTurnLeft:
      Publish({0.0, options_.turn_rps});
      break;
    case DriveAction::kTurnRight:
      Publish({0.0, -options_.turn_rps});
      break;
  }
  return true;
}

void PursuitMover::Publish(Velocity velocity) {
  velocity_ = velocity;
  rests_ = velocity == Velocity{} ? rests_ + 1 : 0;
  send_(velocity);
}

void GoalPoseMover::Begin(const Target& target, const Pose& at) {
  target_ = target;
  stood_at_.reset();
  send_(GoalOf(target, at));
}

bool GoalPoseMover::Stands(const Pose& at, Clock::TimePoint now) {
  if (!stood_at_ || Distance(at.position, stood_at_->position) > kStandsM ||
      std::abs(WrapAngle(at.heading_rad - stood_at_->heading_rad)) > kStandsRad) {
    stood_at_ = at;
    stood_since_ = now;
  }
  return now - stood_since_ >= kStandsFor;
}

Mover::Progress GoalPoseMover::Step(const Pose& at, Clock::TimePoint now) {
  const bool stands = Stands(at, now);
  if (!IsAt(target_, at, heading_tolerance_rad_) || (target_.last && !stands)) return {};
  return {State::kArrived, ""};
}

}  // namespace conav::robot
