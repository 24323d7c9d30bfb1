#include <catch2/catch.hpp>

#include "sim/physics/robot_world.h"

namespace conav::sim {
namespace {

RobotPose At(double x_m, double y_m, double heading_rad, double speed_mps = 0.0) {
  return {{x_m, y_m}, heading_rad, speed_mps, 0.0};
}

TEST_CASE("a target straight ahead is driven to at full speed", "[sim][physics]") {
  const ControlDecision decision = DecideMove(At(0, 0, 0), {2, 0}, false);
  CHECK(decision.controls.forward == 1.0);
  CHECK(decision.controls.turn_left == Approx(0.0).margin(0.15));
  CHECK(decision.driving);
}

TEST_CASE("a target to the left is turned to before driving", "[sim][physics]") {
  const ControlDecision decision = DecideMove(At(0, 0, 0), {0, 2}, false);
  CHECK(decision.controls.forward == 0.0);
  CHECK(decision.controls.turn_left == 1.0);
  CHECK_FALSE(decision.driving);
}

TEST_CASE("turning goes the short way round", "[sim][physics]") {
  CHECK(DecideTurn(At(0, 0, 3.0), -3.0).controls.turn_left > 0.0);
  CHECK(DecideTurn(At(0, 0, -3.0), 3.0).controls.turn_left < 0.0);
}

TEST_CASE("speed that coasting brings to the target needs no control", "[sim][physics]") {
  // Coasting distance is the lag of 0.168 s times the speed.
  CHECK(DecideMove(At(0, 0, 0, 1.0), {0.168, 0}, true).controls.forward ==
        Approx(0.0).margin(1e-9));
  CHECK(DecideMove(At(0, 0, 0, 2.0), {0.168, 0}, true).controls.forward < 0.0);
}

TEST_CASE("a primitive has arrived only at rest", "[sim][physics]") {
  CHECK(DecideMove(At(0, 0, 0), {0.02, 0}, true).arrived);
  CHECK_FALSE(DecideMove(At(0, 0, 0, 0.5), {0.02, 0}, true).arrived);
  CHECK(DecideTurn(At(0, 0, 1.0), 1.0).arrived);
  CHECK(DecideHalt(At(0, 0, 0)).arrived);
  CHECK_FALSE(DecideHalt(At(0, 0, 0, 1.0)).arrived);
  CHECK(DecideHalt(At(0, 0, 0, 1.0)).controls.forward < 0.0);
}

}  // namespace
}  // namespace conav::sim
