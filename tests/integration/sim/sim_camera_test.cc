#include <catch2/catch.hpp>
#include <numbers>
#include <opencv2/imgcodecs.hpp>

#include "common/grid/visibility.h"
#include "integration/sim/sim_harness.h"
#include "sim/physics/camera.h"

namespace conav::sim {
namespace {

constexpr double kPi = std::numbers::pi;

}  // namespace

TEST_CASE("a picture is a JPEG of the size asked for, without a camera none, and says what is seen",
          "[sim]") {
  const bool rendered = GENERATE(true, false);
  SimConfig config = BlindConfig();
  config.camera.mode = rendered ? "egl" : "none";
  SimHarness sim(config);
  const OccupancyGrid truth = sim.Truth();
  for (const double heading : {0.0, kPi / 4, kPi / 2, -3 * kPi / 4}) {
    REQUIRE(sim.Do(sim.robot().View(heading)) == CommandOutcome::kDone);
    const Snapshot& snapshot = sim.robot().snapshots.back();
    CameraView view;
    view.cell = sim.robot().state().cell;
    view.heading_rad = heading;
    view.horizontal_fov_rad = 2.0 * std::atan(320.0 / 192.0 * std::tan(40.0 * kPi / 180.0));
    CHECK(snapshot.visible == CastView(truth, view));
    CHECK(snapshot.heading_rad == Approx(heading));
    CHECK(snapshot.horizontal_fov_rad == Approx(view.horizontal_fov_rad));
    CHECK(snapshot.jpeg.empty() != rendered);
    if (!rendered) continue;
    const cv::Mat image = cv::imdecode(snapshot.jpeg, cv::IMREAD_COLOR);
    CHECK(image.cols == 320);
    CHECK(image.rows == 192);
  }
  const RobotState& state = sim.robot().state();
  CHECK(state.images == 4);
  CHECK(state.snapshots == 4);
  std::uint64_t bytes = 0;
  for (const Snapshot& snapshot : sim.robot().snapshots) bytes += snapshot.jpeg.size();
  CHECK(state.image_bytes == bytes);
  CHECK(state.cell_moves == 0);  // a view is a picture, not a move
  CHECK(state.low_level_steps > 0);
  CHECK(sim.robot().snapshots.back().sequence_number == 4);
}

// Report row 26: "default method publishes NO image ... camera_info once, stamp 0 (does not
// synchronise with any image)".
TEST_CASE("a picture is also an image for ROS tools, with a camera_info of its stamp",
          "[sim][row26]") {
  SimConfig config = BlindConfig();
  config.camera.mode = "egl";
  config.camera.width = 64;
  config.camera.height = 48;
  SimHarness sim(config);
  bus::Subscriber<sensor_msgs::msg::CompressedImage> images(sim.peer(), bus::kCameraImage, "r1");
  std::vector<sensor_msgs::msg::CameraInfo> infos;
  const bus::Subscriber<sensor_msgs::msg::CameraInfo> info(
      sim.peer(), bus::kCameraInfo, "r1", [&](auto&& message) { infos.push_back(message); });
  REQUIRE(sim.Do(sim.robot().View(1.0)) == CommandOutcome::kDone);
  const auto taken = images.Take();
  REQUIRE(taken.size() == 1);
  const Snapshot& snapshot = sim.robot().snapshots.back();
  CHECK(taken[0].data() == snapshot.jpeg);
  CHECK(taken[0].format() == "jpeg");
  CHECK(taken[0].header().frame_id() == "camera_optical_frame");
  CHECK(ToDomain(taken[0].header().stamp()).value() == snapshot.stamp);
  REQUIRE(infos.size() == 2);  // the first was there before all pictures
  CHECK(infos[1].header() == taken[0].header());
  CHECK(sim.Latched(bus::kCameraInfo, "r1").header() == taken[0].header());
  CHECK(infos[0].k() == infos[1].k());
  CHECK(sim.robot().state().camera_bytes == 0);  // sent as a picture, not for viewers
}

TEST_CASE("a streaming camera sends a frame per control step, and what it shows", "[sim]") {
  const bool rendered = GENERATE(true, false);
  SimConfig config = BlindConfig();
  config.camera.mode = rendered ? "egl" : "none";
  config.camera.stream = true;
  config.camera.width = 64;
  config.camera.height = 64;
  SimHarness sim(config);
  const Cell start = sim.robot().state().cell;
  REQUIRE(sim.Step() == CommandOutcome::kDone);
  const RobotState& state = sim.robot().state();
  CHECK(sim.robot().frames == (rendered ? static_cast<int>(state.low_level_steps) : 0));
  CHECK((state.image_bytes > 0) == rendered);
  CHECK(state.images == state.low_level_steps);
  CHECK(state.snapshots == state.low_level_steps);
  REQUIRE(sim.robot().snapshots.size() == state.low_level_steps);
  for (const Snapshot& snapshot : sim.robot().snapshots) {
    CHECK(snapshot.streamed);
    CHECK(snapshot.jpeg.empty());  // the pixels are the frame's
    CHECK_FALSE(snapshot.visible.walls.empty());
  }
  CHECK(sim.robot().snapshots.front().cell == start);
  CHECK(sim.robot().snapshots.back().cell == state.cell);
  CHECK(sim.robot().snapshots.back().path == std::vector<Cell>{start, state.cell});
}

TEST_CASE(
    "a robot that stands is seen by those who look on, and these frames do not count as pictures",
    "[sim]") {
  const bool streams = GENERATE(true, false);
  SimConfig config = BlindConfig();
  config.camera.mode = "egl";
  config.camera.stream = streams;
  config.camera.live_hz = 2.0;
  SimHarness sim(config);
  sim.Turn();
  CHECK(sim.robot().frames == 0);
  for (int frames = 1; frames <= 2; ++frames) {
    sim.clock.Advance(std::chrono::milliseconds(500));
    sim.Turn();
    sim.Turn();
    CHECK(sim.robot().frames == frames);
  }
  CHECK(sim.robot().state().images == 0);
  CHECK((sim.robot().state().camera_bytes > 0) == !streams);
  CHECK(sim.robot().snapshots.empty());
}

TEST_CASE(
    "a streamed picture shows what is seen from where the robot is, not from its cell's middle",
    "[sim]") {
  SimConfig config = BlindConfig();
  config.camera.stream = true;
  SimHarness sim(config);
  const OccupancyGrid truth = sim.Truth();
  for (int i = 0; i < 3; ++i)
    REQUIRE(sim.Do(sim.robot().Key(DriveAction::kForward)) != CommandOutcome::kExpired);
  const RobotState& state = sim.robot().state();
  const Snapshot& snapshot = sim.robot().snapshots.back();
  CHECK(snapshot.sequence_number == state.snapshots);
  const GridGeometry geometry{truth.rows(), truth.columns(), 2.0};
  const Position centre = geometry.CellToPosition(state.cell);
  CameraView view =
      ViewAt(state.cell, state.heading_rad, 2.0, config.camera.width, config.camera.height);
  view.east_offset_cells = (state.position.x_m - centre.x_m) / 2.0;
  view.south_offset_cells = (centre.y_m - state.position.y_m) / 2.0;
  CHECK(snapshot.visible == CastView(truth, view));
}

}  // namespace conav::sim
