#include "robot/driver/alignment.h"

#include <catch2/catch.hpp>
#include <limits>
#include <numbers>
#include <vector>

namespace conav::robot {
namespace {

constexpr double kQuarter = std::numbers::pi / 2.0;

TEST_CASE("a pose carries places and poses into its parent's frame, and back", "[robot][driver]") {
  const Pose map_from_odom{{10.0, 5.0}, kQuarter};
  const Position place = map_from_odom * Position{2.0, 1.0};
  CHECK(place.x_m == Approx(9.0));
  CHECK(place.y_m == Approx(7.0));
  const Pose base = map_from_odom * Pose{{2.0, 1.0}, kQuarter};
  CHECK(base.heading_rad == Approx(std::numbers::pi));
  const Pose back = Inverse(map_from_odom) * base;
  CHECK(back.position.x_m == Approx(2.0));
  CHECK(back.position.y_m == Approx(1.0));
  CHECK(back.heading_rad == Approx(kQuarter));
}

TEST_CASE("three pairs of points give the turn and the place of the robot's map",
          "[robot][driver]") {
  const Pose truth{{100.0, -50.0}, 0.7};
  std::vector<PointPair> pairs;
  for (const Position robot : {Position{0.0, 0.0}, Position{5.0, 1.0}, Position{2.0, 6.0}}) {
    pairs.push_back({robot, truth * robot});
  }
  const auto exact = AlignByPairs(pairs, 0.1);
  REQUIRE(exact);
  CHECK(exact->plan_from_robot.position.x_m == Approx(100.0));
  CHECK(exact->plan_from_robot.position.y_m == Approx(-50.0));
  CHECK(exact->plan_from_robot.heading_rad == Approx(0.7));
  CHECK(exact->residual_m == Approx(0.0).margin(1e-9));

  pairs[1].plan.x_m += 0.3;
  const auto clicked = AlignByPairs(pairs, 0.5);
  REQUIRE(clicked);
  CHECK(clicked->residual_m > 0.05);
  CHECK(clicked->residual_m < 0.3);
}

TEST_CASE("a single turn about the middle is found by hand: 1 m to the left of each arm",
          "[robot][driver]") {
  // Arms (1,0), (0,1), (-1,-1) turned by 90 degrees: (0,1), (-1,0), (1,-1).
  const std::vector<PointPair> pairs{
      {{1.0, 0.0}, {0.0, 1.0}}, {{0.0, 1.0}, {-1.0, 0.0}}, {{-1.0, -1.0}, {1.0, -1.0}}};
  const auto found = AlignByPairs(pairs, 0.01);
  REQUIRE(found);
  CHECK(found->plan_from_robot.heading_rad == Approx(kQuarter));
}

TEST_CASE("pairs that cannot be right are refused by what is wrong with them", "[robot][driver]") {
  struct Row {
    std::vector<PointPair> pairs;
    std::string names;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Row row = GENERATE_COPY(
      Row{{{{0, 0}, {0, 0}}, {{1, 0}, {1, 0}}}, "2 pairs"},
      Row{{{{1, 1}, {0, 0}}, {{1, 1}, {1, 0}}, {{1, 1}, {2, 0}}}, "coincide"},
      Row{{{{nan, 1}, {0, 0}}, {{1, 2}, {1, 0}}, {{3, 1}, {2, 0}}}, "numbers"},
      // A mirrored map, and one of another scale, fit no rigid motion.
      Row{{{{0, 0}, {0, 0}}, {{4, 0}, {4, 0}}, {{0, 3}, {0, -3}}}, "off the best fit"},
      Row{{{{0, 0}, {0, 0}}, {{4, 0}, {8, 0}}, {{0, 3}, {0, 6}}}, "off the best fit"});
  const auto refused = AlignByPairs(row.pairs, 0.5);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::kInvalidArgument);
  CHECK_THAT(refused.error().text, Catch::Contains(row.names));
}

}  // namespace
}  // namespace conav::robot
