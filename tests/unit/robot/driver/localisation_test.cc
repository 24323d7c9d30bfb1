#include "robot/driver/localisation.h"

#include <catch2/catch.hpp>

namespace conav::robot {
namespace {

using namespace std::chrono_literals;
constexpr Clock::TimePoint kStart{};

TEST_CASE("the robot is found along its frames, with the age of what moves", "[robot][driver]") {
  FrameTree frames;
  CHECK_FALSE(frames.Find("map", "base_link"));
  frames.Set("base_link", {"base_footprint", {{0.0, 0.0}, 0.0}, kStart, true});
  frames.Set("base_footprint", {"odom", {{2.0, 0.0}, 0.0}, kStart + 3s});
  CHECK_FALSE(frames.Find("map", "base_link"));
  frames.Set("/odom", {"/map", {{10.0, 1.0}, 1.5707963267948966}, kStart + 1s});
  const auto found = frames.Find("map", "base_link");
  REQUIRE(found);
  CHECK(found->pose.position.x_m == Approx(10.0));
  CHECK(found->pose.position.y_m == Approx(3.0));
  CHECK(found->motion == kStart + 3s);
  CHECK(found->correction == kStart + 1s);
  // A ring of frames leads nowhere.
  frames.Set("map", {"base_link", {}, kStart});
  CHECK_FALSE(frames.Find("earth", "base_link"));
}

FrameTree::Found Seen(double x_m, Clock::TimePoint motion,
                      std::optional<Clock::TimePoint> correction = std::nullopt) {
  return {{{x_m, 0.0}, 0.0}, motion, correction};
}

TEST_CASE("a place is lost while odometry or the map's correction is silent", "[robot][driver]") {
  Localisation localisation({.timeout_s = 1.0, .correction_timeout_s = 5.0});
  localisation.Step(std::nullopt, kStart);
  CHECK_FALSE(localisation.pose());
  CHECK_FALSE(localisation.problem().empty());
  localisation.Step(Seen(0.0, kStart, kStart), kStart);
  CHECK(localisation.problem().empty());
  localisation.Step(Seen(0.0, kStart, kStart), kStart + 1100ms);
  CHECK_THAT(localisation.problem(), Catch::Contains("odometry silent"));
  localisation.Step(Seen(0.1, kStart + 5100ms, kStart), kStart + 5100ms);
  CHECK_THAT(localisation.problem(), Catch::Contains("correction silent"));
  localisation.Step(Seen(0.1, kStart + 5200ms, kStart + 5200ms), kStart + 5200ms);
  CHECK(localisation.problem().empty());
  localisation.Step(std::nullopt, kStart + 5300ms);
  CHECK_THAT(localisation.problem(), Catch::Contains("frames"));
  CHECK(localisation.pose());
}

TEST_CASE("a jump that the robot cannot have driven loses its place until it has settled",
          "[robot][driver]") {
  Localisation localisation({.jump_m = 0.5, .settle_s = 2.0, .top_speed_mps = 1.0});
  localisation.Step(Seen(0.0, kStart), kStart);
  localisation.Step(Seen(0.4, kStart + 50ms), kStart + 50ms);  // a correction
  CHECK(localisation.problem().empty());
  localisation.Step(Seen(3.4, kStart + 100ms), kStart + 100ms);
  CHECK_THAT(localisation.problem(), Catch::Contains("jumped by 3.0 m"));
  CHECK(localisation.jumps() == 1);
  localisation.Step(Seen(3.4, kStart + 1s), kStart + 1s);
  CHECK_FALSE(localisation.problem().empty());
  localisation.Step(Seen(3.4, kStart + 2200ms), kStart + 2200ms);
  CHECK(localisation.problem().empty());
  CHECK(localisation.pose()->position.x_m == 3.4);
}

}  // namespace
}  // namespace conav::robot
