#include <cmath>
#include <limits>
#include <numbers>

#include "unit/common/msg/convert_expectations.h"
#include "unit/common/msg/samples.h"

namespace conav {
namespace {

using samples::SampleMap;
using samples::Stamp;
using Map = nav_msgs::msg::OccupancyGrid;

TEST_CASE("Maps and simulation times survive the wire", "[convert]") {
  CheckRoundTrips(SampleMap(), Stamp(12), SimTime{});
}

TEST_CASE("Simulation time outside of the wire's range saturates", "[convert]") {
  CHECK(ToMessage(SimTime{-5}).nanosec() == 0);
  const auto late = ToMessage(SimTime{std::numeric_limits<std::int64_t>::max()});
  CHECK(late.sec() == std::numeric_limits<std::int32_t>::max());
  CHECK(late.nanosec() == 999'999'999);
}

TEST_CASE("A malformed time is refused", "[convert]") {
  using Time = builtin_interfaces::msg::Time;
  CheckRefused(Stamp(1), {
                             {"sec", [](Time& m) { m.sec(-1); }},
                             {"nanosec", [](Time& m) { m.nanosec(1'000'000'000); }},
                         });
}

TEST_CASE("A map's message starts with the southern row", "[convert]") {
  const Map message = ToMessage(SampleMap());
  CHECK(message.header().frame_id() == "map");
  CHECK(message.info().width() == 3);
  CHECK(message.info().height() == 2);
  CHECK(message.info().origin().position().x() == 10.25 - 3.75);
  CHECK(message.info().origin().position().y() == -4.5 - 2.5);
  CHECK(message.data() == std::vector<std::int8_t>{-1, -1, 0, 100, -1, -1});
}

TEST_CASE("A map may have any origin, and one that is centred but for rounding is exactly that",
          "[convert]") {
  Map message = ToMessage(SampleMap());
  message.info().resolution(0.05F);
  message.info().origin().position().x(-12.5);
  message.info().origin().position().y(3.0);
  const GridGeometry grid = ToDomain(message).value().geometry();
  CHECK(grid.CellToPosition({1, 0}).x_m == Approx(-12.475));
  CHECK(grid.CellToPosition({1, 0}).y_m == Approx(3.025));
  message.info().origin().position().x(-0.0750001);
  message.info().origin().position().y(-0.0499999);
  CHECK(ToDomain(message).value().middle == Position{});
  message.info().origin().orientation().w(0.0);  // all zeros, as many tools leave it
  CHECK(ToDomain(message));
}

TEST_CASE("A map with probabilities is read in three values", "[convert]") {
  Map message = ToMessage(SampleMap());
  message.data() = {25, 26, 64, 65, 0, 100};
  const auto map = ToDomain(message);
  REQUIRE(map);
  CHECK(map->cells[{1, 0}] == Occupancy::kFree);
  CHECK(map->cells[{1, 1}] == Occupancy::kUnknown);
  CHECK(map->cells[{1, 2}] == Occupancy::kUnknown);
  CHECK(map->cells[{0, 0}] == Occupancy::kOccupied);
}

TEST_CASE("A map that does not fit is refused", "[convert]") {
  CheckRefused(
      SampleMap(),
      {
          {"header.frame_id", [](Map& m) { m.header().frame_id("odom"); }},
          {"header.stamp.sec", [](Map& m) { m.header().stamp().sec(-3); }},
          {"info.resolution", [](Map& m) { m.info().resolution(NAN); }},
          {"info.resolution", [](Map& m) { m.info().resolution(0.0F); }},
          {"rows", [](Map& m) { m.info().height(0); }},
          {"columns", [](Map& m) { m.info().width(2049); }},
          {"data", [](Map& m) { m.data().pop_back(); }},
          {"data[4]", [](Map& m) { m.data()[4] = 101; }},
          {"data[0]", [](Map& m) { m.data()[0] = -2; }},
          {"info.origin.position.x", [](Map& m) { m.info().origin().position().x(2.0e6); }},
          {"info.origin.position.y", [](Map& m) { m.info().origin().position().y(NAN); }},
          {"info.origin.orientation.x", [](Map& m) { m.info().origin().orientation().x(1.0); }},
          {"info.origin.orientation.z", [](Map& m) { m.info().origin().orientation().z(0.5); }},
      });
}

TEST_CASE("The operator's map is shown in percent", "[convert]") {
  const Map message = ToOccupancyMessage(samples::SampleBelief());
  CHECK(message.data() == std::vector<std::int8_t>{10, 25, 25, 25, 25, 100});
  CHECK(message.info().resolution() == 0.5F);
  CHECK(message.info().origin().position().x() == 3.0 - 0.75);
}

TEST_CASE("A goal pose becomes a position in the map frame", "[convert]") {
  geometry_msgs::msg::PoseStamped message;
  message.header(ToHeader({}));
  message.pose().position().x(1.5);
  message.pose().position().y(-2.0);
  const auto goal = ToDomain(message);
  REQUIRE(goal);
  CHECK(goal->x_m == 1.5);
  CHECK(goal->y_m == -2.0);

  for (const double y : {std::nan(""), 2.0e6}) {
    message.pose().position().y(y);
    CHECK_THAT(ToDomain(message).error().text, Catch::StartsWith("pose.position.y = "));
  }
  message.header().frame_id("r1/base_link");
  CHECK_THAT(ToDomain(message).error().text, Catch::StartsWith("header.frame_id = "));
}

TEST_CASE("A camera's info becomes its fields of view", "[convert]") {
  sensor_msgs::msg::CameraInfo message;
  message.width(320);
  message.height(192);
  const double focal = 96.0 / std::tan(kCameraVerticalFovRad / 2.0);
  message.k({focal, 0.0, 160.0, 0.0, focal, 96.0, 0.0, 0.0, 1.0});
  const auto lens = ToDomain(message);
  REQUIRE(lens);
  CHECK(lens->width == 320);
  CHECK(lens->height == 192);
  CHECK(lens->horizontal_fov_rad == Approx(HorizontalFov(320, 192)));
  CHECK(lens->vertical_fov_rad == Approx(kCameraVerticalFovRad));

  const auto refusal = [good = message](auto&& spoil) {
    auto spoilt = good;
    spoil(spoilt);
    return ToDomain(spoilt).error().text;
  };
  CHECK_THAT(refusal([](auto& m) { m.width(0); }), Catch::StartsWith("width = 0 "));
  CHECK_THAT(refusal([](auto& m) { m.k()[0] = 0.0; }), Catch::StartsWith("k[0] = 0 "));
  CHECK_THAT(refusal([](auto& m) { m.k()[4] = 1.0; }), Catch::Contains("vertical field of view"));
}

TEST_CASE("A path's poses are cell centres turned towards the next", "[convert]") {
  const std::vector<Cell> cells{{1, 0}, {1, 1}, {0, 1}};
  const auto path = ToPathMessage(Stamp(2), cells, {2, 2, 2.0});
  REQUIRE(path.poses().size() == 3);
  CHECK(path.poses()[0].pose().position().x() == -1.0);
  CHECK(path.poses()[0].pose().position().y() == -1.0);
  CHECK(path.poses()[0].pose().orientation().w() == 1.0);
  const double quarter = std::sin(std::numbers::pi / 4.0);
  CHECK(path.poses()[1].pose().orientation().z() == Approx(quarter));
  CHECK(path.poses()[2].pose().orientation().z() == Approx(quarter));
  CHECK(path.poses()[2].pose().position().y() == 1.0);
  CHECK(path.header().stamp().sec() == 2);
  const std::vector<Position> positions = ToPositions(path);
  REQUIRE(positions.size() == 3);
  CHECK(positions[1] == Position{1.0, -1.0});
  CHECK(ToPositions({}).empty());
}

// Report row 25: "No odom frame (Odometry.header.frame_id is `map`, against REP-105)".
TEST_CASE("A robot's motion becomes odometry in odom", "[convert][row25]") {
  const auto odometry = ToOdometry(Stamp(1), {{1.0, 2.0}, std::numbers::pi, 0.5, -0.25});
  CHECK(odometry.header().stamp().sec() == 1);
  CHECK(odometry.header().frame_id() == "odom");
  CHECK(odometry.child_frame_id() == "base_link");
  CHECK(odometry.pose().pose().position().y() == 2.0);
  CHECK(odometry.pose().pose().orientation().z() == Approx(1.0));
  CHECK(odometry.twist().twist().linear().x() == 0.5);
  CHECK(odometry.twist().twist().angular().z() == -0.25);
}

TEST_CASE("A transform names its frames plainly or with the robot, the map never", "[convert]") {
  const FramePose pose{1.0, 2.0, 3.0, 0.0, 0.0, std::numbers::pi};
  const auto plain = ToTransform(Stamp(1), "", kMapFrame, kOdometryFrame, pose);
  CHECK(plain.header().stamp().sec() == 1);
  CHECK(plain.header().frame_id() == "map");
  CHECK(plain.child_frame_id() == "odom");
  CHECK(plain.transform().translation().x() == 1.0);
  CHECK(plain.transform().translation().y() == 2.0);
  CHECK(plain.transform().translation().z() == 3.0);
  CHECK(plain.transform().rotation().z() == Approx(1.0));
  const auto root = ToTransform(Stamp(1), "r1", kMapFrame, kOdometryFrame, pose);
  CHECK(root.header().frame_id() == "map");
  CHECK(root.child_frame_id() == "r1/odom");
  const auto base = ToTransform(Stamp(1), "r1", kOdometryFrame, kBaseFrame, pose);
  CHECK(base.header().frame_id() == "r1/odom");
  CHECK(base.child_frame_id() == "r1/base_link");
}

TEST_CASE("Roll, pitch and yaw are about fixed axes, in this order", "[convert]") {
  constexpr double kQuarter = std::numbers::pi / 2.0;
  // REP-103's turn from a body (x forward) to a camera's optical frame (z forward, x right).
  const auto optical = ToQuaternion(FramePose{0.0, 0.0, 0.0, -kQuarter, 0.0, -kQuarter});
  CHECK(optical.x() == Approx(-0.5));
  CHECK(optical.y() == Approx(0.5));
  CHECK(optical.z() == Approx(-0.5));
  CHECK(optical.w() == Approx(0.5));
  const auto down = ToQuaternion(FramePose{0.0, 0.0, 0.0, 0.0, 0.2, 0.0});
  CHECK(down.y() == Approx(std::sin(0.1)));
  CHECK(down.w() == Approx(std::cos(0.1)));
}

}  // namespace
}  // namespace conav
