#include "operator/simulated/steering.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace conav;
using namespace conav::operators;

namespace {

constexpr double kPi = 3.14159265358979;
/// 5 x 5 cells of 2 m; cell (2,2) has the origin in its middle.
const GridGeometry geometry{5, 5, 2.0};
const SteeringParameters hands;

DriveAction Key(const ShownPose& pose, const std::vector<Cell>& path, bool to_centre = false) {
  return ChooseKey(hands, geometry, pose, path, to_centre);
}

}  // namespace

TEST_CASE("a key is expected to do what the parameters say", "[operator][teleoperator]") {
  const ShownPose north{{0.0, 0.0}, kPi / 2};
  CHECK(Expect(hands, north, DriveAction::kForward).position.y_m == Approx(0.2));
  CHECK(Expect(hands, north, DriveAction::kBackward).position.y_m == Approx(-0.1));
  CHECK(Expect(hands, north, DriveAction::kTurnLeft).heading_rad == Approx(kPi / 2 + kPi / 16));
  CHECK(Expect(hands, north, DriveAction::kTurnRight).heading_rad == Approx(kPi / 2 - kPi / 16));
  CHECK(Expect(hands, north, DriveAction::kStop).heading_rad == north.heading_rad);
}

TEST_CASE("the robot turns the short way to its path, then goes forward",
          "[operator][teleoperator]") {
  const std::vector<Cell> east{{2, 2}, {2, 3}};
  CHECK(Key({{0.0, 0.0}, 0.0}, east) == DriveAction::kForward);
  CHECK(Key({{0.0, 0.0}, 1.0}, east) == DriveAction::kTurnRight);
  CHECK(Key({{0.0, 0.0}, -1.0}, east) == DriveAction::kTurnLeft);
  CHECK(Key({{0.0, 0.0}, 3.0}, east) == DriveAction::kTurnRight);
}

TEST_CASE("half a turn's error is left alone: keys turn by 11.25 degrees",
          "[operator][teleoperator]") {
  const std::vector<Cell> east{{2, 2}, {2, 3}, {2, 4}};
  CHECK(Key({{0.0, 0.0}, 0.09}, east) == DriveAction::kForward);
  CHECK(Key({{0.0, 0.0}, 0.16}, east) == DriveAction::kTurnRight);
}

TEST_CASE("at the end of the path the robot stops", "[operator][teleoperator]") {
  CHECK(Key({{0.0, 0.0}, 0.0}, {{2, 2}}) == DriveAction::kStop);
}

TEST_CASE("a corner is turned near its middle, not at the edge of the cell",
          "[operator][teleoperator]") {
  const std::vector<Cell> north{{2, 2}, {1, 2}};
  CHECK(Key({{-0.9, 0.0}, 0.0}, north) == DriveAction::kForward);  // just come in from the west
  CHECK(Key({{-0.3, 0.0}, 0.0}, north) == DriveAction::kTurnLeft);
  CHECK(Key({{0.5, 0.0}, 0.0}, north) == DriveAction::kTurnLeft);  // a bit too far
}

TEST_CASE("after a bump the robot goes back to the middle of its cell, backward if that is behind",
          "[operator][teleoperator]") {
  const std::vector<Cell> east{{2, 2}, {2, 3}};
  CHECK(Key({{0.7, 0.0}, 0.0}, east, true) == DriveAction::kBackward);
  CHECK(Key({{0.7, 0.0}, kPi}, east, true) == DriveAction::kForward);
  CHECK(Key({{0.7, 0.0}, kPi / 2}, east, true) == DriveAction::kTurnLeft);
}

TEST_CASE("off the middle is measured on the worse axis, in cells", "[operator][teleoperator]") {
  CHECK(OffCentre(geometry, {0.2, -0.6}, {2, 2}) == Approx(0.3));
}
