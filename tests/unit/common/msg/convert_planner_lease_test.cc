#include "unit/common/msg/convert_expectations.h"

using namespace conav;

namespace {

using Message = conav_msgs::msg::PlannerLease;

PlannerLease Sample() {
  return {.node = "planner-2",
          .instance = "0193-ab12-planner-2",
          .robots = {"r1", "r2"},
          .holds = {{"r2", 7}},
          .load = 0.25};
}

}  // namespace

TEST_CASE("an announcement of a planner comes back as it was", "[protocol][convert]") {
  CheckRoundTrip(Sample());
  PlannerLease farewell = Sample();
  farewell.holds.clear();
  farewell.leaving = true;
  CheckRoundTrip(farewell);
}

TEST_CASE("the way that a robot wants comes back as it was", "[protocol][convert]") {
  CheckRoundTrip(
      IntendedPath{"r1", {{1, 2}, {1, 3}}, {{{2, 2}}, {RightOfWay::kWantsAWay, "r2", 3}}});
  CheckRoundTrip(IntendedPath{"r1", {}, {}});
}

TEST_CASE("announcements that cannot be are refused", "[protocol][convert]") {
  CheckRefused(
      Sample(), [](Message& message) { message.node("a b"); },
      "node = 'a b' has a character outside of [A-Za-z0-9_.:@/-]");
  CheckRefused(
      Sample(), [](Message& message) { message.instance(""); }, "instance is empty");
  CheckRefused(
      Sample(),
      [](Message& message) {
        message.robots({"r1", "r1"});
      },
      "robots: r1 is there twice");
  CheckRefused(
      Sample(), [](Message& message) { message.holds()[0].lease_epoch(0); },
      "holds[0].lease_epoch = 0 is below 1");
  CheckRefused(
      Sample(), [](Message& message) { message.holds().push_back(message.holds()[0]); },
      "holds: r2 is there twice");
  CheckRefused(
      Sample(), [](Message& message) { message.leaving(true); }, "leaving, and holds robots");
  CheckRefused(
      Sample(), [](Message& message) { message.load(-1.0); },
      "load = -1 is not in [0, 2147483647]");
}

TEST_CASE("a way of a robot without a name is refused", "[protocol][convert]") {
  CHECK_FALSE(ToDomain(conav_msgs::msg::IntendedPath()));
  CheckRefused(
      IntendedPath{"r1", {}, {}},
      [](conav_msgs::msg::IntendedPath& message) { message.room_tier(4); },
      "room_tier = 4 is not in [0, 3]");
}
