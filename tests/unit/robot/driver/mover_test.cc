#include "robot/driver/mover.h"

#include <catch2/catch.hpp>
#include <numbers>
#include <vector>

namespace conav::robot {
namespace {

using namespace std::chrono_literals;

/// A body that obeys at once.
struct Body {
  Pose at;
  Velocity velocity;
  double fastest_mps = 0.0;
  int sent = 0;

  PursuitMover::Send Receiver() {
    return [this](const Velocity& asked) {
      velocity = asked;
      ++sent;
      fastest_mps = std::max(fastest_mps, std::abs(asked.forward_mps));
    };
  }
  void Move(double seconds) {
    at = at * Pose{{velocity.forward_mps * seconds, 0.0}, velocity.turn_rps * seconds};
  }
  /// Steps until it has arrived; the time that it took, s, 60 at most.
  double Drive(Mover& mover, const Target& target) {
    mover.Begin(target, at);
    Clock::TimePoint now{};
    for (int i = 1; i <= 1200; ++i) {
      now += 50ms;
      if (mover.Step(at, now).state == Mover::State::kArrived) return i * 0.05;
      Move(0.05);
    }
    return 60.0;
  }
};

TEST_CASE("pursuit drives to a place from any side, turns to the heading asked for and stands",
          "[robot][driver]") {
  const double bearing_rad = GENERATE(0.0, 0.4, 1.6, 3.1, -2.0);
  const double heading_rad = GENERATE(0.0, -1.5, 3.0);
  Body body;
  PursuitMover mover({.speed_mps = 0.5, .turn_rps = 1.0}, body.Receiver());
  const Position place{2.0 * std::cos(bearing_rad), 2.0 * std::sin(bearing_rad)};
  CAPTURE(bearing_rad, heading_rad);
  CHECK(body.Drive(mover, {place, 0.1, heading_rad}) < 25.0);
  CHECK(Distance(body.at.position, place) <= 0.1);
  CHECK(std::abs(WrapAngle(body.at.heading_rad - heading_rad)) <= 0.05);
  CHECK(body.velocity == Velocity{});
  CHECK(body.fastest_mps <= 0.5);
}

TEST_CASE("pursuit does not stand at a place on its way", "[robot][driver]") {
  Body body;
  PursuitMover mover({.speed_mps = 0.5, .turn_rps = 1.0}, body.Receiver());
  body.Drive(mover, {{1.0, 0.0}, 0.15, std::nullopt, false});
  CHECK(body.velocity.forward_mps > 0.4);
  body.Drive(mover, {{2.0, 0.0}, 0.1, std::nullopt, true});
  CHECK(body.velocity == Velocity{});
}

TEST_CASE("pursuit stands at once when it is cancelled, and says so for half a second",
          "[robot][driver]") {
  Body body;
  PursuitMover mover({}, body.Receiver());
  mover.Begin({{2.0, 0.0}}, body.at);
  mover.Step(body.at, Clock::TimePoint{});
  CHECK(body.velocity.forward_mps > 0.0);
  mover.Cancel(body.at);
  CHECK(body.velocity == Velocity{});
  body.sent = 0;
  for (int i = 0; i < 50; ++i) mover.Rest();
  CHECK(body.sent > 5);
  CHECK(body.sent < 15);  // then others may drive it
}

TEST_CASE("a drive step goes on until it is cancelled", "[robot][driver]") {
  Body body;
  PursuitMover mover({.speed_mps = 0.4, .turn_rps = 0.7}, body.Receiver());
  CHECK(mover.Drive(DriveAction::kForward));
  CHECK(body.velocity == Velocity{0.4, 0.0});
  CHECK(mover.Drive(DriveAction::kBackward));
  CHECK(body.velocity.forward_mps < 0.0);
  CHECK(mover.Drive(DriveAction::kTurnLeft));
  CHECK(body.velocity == Velocity{0.0, 0.7});
  CHECK(mover.Drive(DriveAction::kTurnRight));
  CHECK(body.velocity == Velocity{0.0, -0.7});
  mover.Cancel(body.at);
  CHECK(body.velocity == Velocity{});
}

TEST_CASE("a follower of goals gets one goal a target, and has arrived when the robot is there",
          "[robot][driver]") {
  std::vector<Pose> goals;
  GoalPoseMover mover(0.1, [&](const Pose& goal) { goals.push_back(goal); });
  const Pose at{{1.0, 1.0}, 0.0};
  mover.Begin({{1.0, 3.0}, 0.2, std::nullopt}, at);
  REQUIRE(goals.size() == 1);
  CHECK(goals[0].heading_rad == Approx(std::numbers::pi / 2.0));  // as it comes
  Clock::TimePoint now{};
  // Where it is after so long there, standing.
  const auto after = [&](const Pose& place, std::chrono::milliseconds time) {
    mover.Step(place, now);
    return mover.Step(place, now += time).state;
  };
  CHECK(after(at, 1s) == Mover::State::kDriving);
  CHECK(after({{1.0, 2.9}, 0.0}, 100ms) == Mover::State::kDriving);  // it may roll on
  CHECK(after({{1.0, 2.9}, 0.0}, 1s) == Mover::State::kArrived);
  mover.Begin({{1.0, 3.0}, 0.2, 1.0}, at);
  CHECK(goals[1].heading_rad == 1.0);
  CHECK(after({{1.0, 2.9}, 0.0}, 1s) == Mover::State::kDriving);
  CHECK(after({{1.0, 2.9}, 1.05}, 1s) == Mover::State::kArrived);
  mover.Begin({{1.0, 3.0}, 0.2, std::nullopt, false}, at);
  CHECK(mover.Step({{1.0, 2.9}, 0.0}, now).state == Mover::State::kArrived);  // on its way
  mover.Cancel(at);
  CHECK(goals.back() == at);
  CHECK_FALSE(mover.Drive(DriveAction::kForward));
}

}  // namespace
}  // namespace conav::robot
