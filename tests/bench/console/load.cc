#include "bench/console/load.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <numeric>

#include "bench/support/measure.h"
#include "common/bus/publisher.h"
#include "common/bus/topics.h"
#include "common/msg/convert.h"
#include "common/runtime/clock.h"
#include "common/runtime/result.h"
#include "sim/config.h"
#include "sim/physics/camera.h"
#include "sim/world/world_spec.h"

namespace conav::bench {
namespace {

constexpr int kPictures = 8;

template <class T>
T Checked(Result<T> result) {
  if (!result) throw StartupError("pictures of the camera: " + result.error().text);
  return std::move(result.value());
}

std::unique_ptr<sim::RobotWorld> MakeMaze() {
  const sim::WorldSpec spec = Checked(sim::MakeWorldSpec({}));
  sim::PhysicsWorld world;
  world.truth = spec.truth;
  world.wall_classes = spec.wall_classes;
  world.floor_classes = spec.floor_classes;
  world.robots = {{"r1", spec.starts.front(), 0.0}};
  return Checked(sim::RobotWorld::Create(std::move(world)));
}

/// JPEGs of the simulator's camera in a maze, in its usual size and quality. Throws StartupError.
std::vector<std::vector<std::uint8_t>> CameraPictures(int count) {
  const sim::CameraConfig config;
  const auto maze = MakeMaze();
  const auto camera = Checked(sim::Camera::Open(*maze, {config.width, config.height}));
  const Position start = maze->pose(0).position;
  std::vector<std::vector<std::uint8_t>> pictures;
  for (int i = 0; i < count; ++i) {
    maze->Teleport(0, start, 2.0 * std::numbers::pi * i / count);
    pictures.push_back(Checked(sim::EncodeJpeg(camera->Render(0), config.jpeg_quality)));
  }
  return pictures;
}

}  // namespace

int StatesPerPicture(const LoadOptions& options) {
  return std::max(1, static_cast<int>(std::lround(options.state_hz / options.picture_hz)));
}

struct Load::WorldLink {
  explicit WorldLink(bus::Participant& participant)
      : initial_map(participant, bus::kInitialMap, "w1") {}
  bus::Publisher<nav_msgs::msg::OccupancyGrid> initial_map;
};

struct Load::RobotLink {
  RobotLink(bus::Participant& participant, const Drive& drive, const OccupancyGrid& truth,
            int number)
      : number(number),
        robot(drive, truth, number),
        state(participant, bus::kRobotState, RobotName(number)),
        map(participant, bus::kRobotMap, RobotName(number)),
        snapshot(participant, bus::kSnapshot, RobotName(number)),
        frame(participant, bus::kCameraImage, RobotName(number)),
        attention(participant, bus::kAttention, RobotName(number)) {}

  int number;
  DrivingRobot robot;
  bus::Publisher<conav_msgs::msg::RobotState> state;
  bus::Publisher<nav_msgs::msg::OccupancyGrid> map;
  bus::Publisher<conav_msgs::msg::Snapshot> snapshot;
  bus::Publisher<sensor_msgs::msg::CompressedImage> frame;
  /// Says nothing; without one the service would take the planner for gone.
  bus::Publisher<conav_msgs::msg::AttentionRequest> attention;
};

Load::Load(bus::Participant& participant, const LoadOptions& options)
    : options_(options),
      truth_(TrueMap(options_.drive)),
      jpegs_(CameraPictures(kPictures)),
      world_(std::make_unique<WorldLink>(participant)) {
  for (int i = 0; i < options_.drive.robots; ++i) {
    robots_.push_back(std::make_unique<RobotLink>(participant, options_.drive, truth_, i));
  }
  bus::Send(world_->initial_map,
            ToMessage(MapUpdate{SimTime{}, Drive::kCellSizeM, InitialMap(truth_)}));
  thread_ = std::thread([this] { Run(); });
}

Load::~Load() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  stopped_.notify_all();
  thread_.join();
}

std::size_t Load::picture_bytes() const {
  const auto add = [](std::size_t sum, const auto& jpeg) { return sum + jpeg.size(); };
  return std::accumulate(jpegs_.begin(), jpegs_.end(), std::size_t{0}, add) / jpegs_.size();
}

void Load::Run() {
  const double period_s = 1.0 / options_.state_hz;
  const double begin_s = WallSeconds();
  for (std::uint64_t round = 0;; ++round) {
    for (const auto& robot : robots_) {
      const double share = static_cast<double>(robot->number) / options_.drive.robots;
      const double due_s = begin_s + (static_cast<double>(round) + share) * period_s;
      if (!WaitUntil(due_s)) return;
      Publish(*robot, round, due_s);
    }
    cpu_s_ = ThreadSeconds();
  }
}

bool Load::WaitUntil(double wall_s) {
  const std::chrono::duration<double> left(wall_s - WallSeconds());
  std::unique_lock lock(mutex_);
  return !stopped_.wait_for(lock, left, [this] { return stop_; });
}

void Load::Publish(RobotLink& link, std::uint64_t round, double due_s) {
  const auto states_per_picture = static_cast<std::uint64_t>(StatesPerPicture(options_));
  const auto number = static_cast<std::uint64_t>(link.number);
  const bool pictures = (round + number) % states_per_picture == 0;
  const double now_s = WallSeconds();
  lateness_ms_ = std::max(lateness_ms_.load(), 1000.0 * (now_s - due_s));
  const RobotState state = link.robot.State(now_s);
  bus::Send(link.state, ToMessage(state));
  if (link.robot.HasNewMap()) bus::Send(link.map, ToMessage(link.robot.Map()));
  if (!pictures) return;
  const auto& jpeg = jpegs_[(round / states_per_picture + number) % jpegs_.size()];
  bus::Send(link.snapshot, ToMessage(link.robot.TakeSnapshot(jpeg)));
  sensor_msgs::msg::CompressedImage frame;
  frame.header().stamp(ToMessage(state.stamp));
  frame.header().frame_id(state.robot + "/camera_optical_frame");
  frame.format("jpeg");
  frame.data(jpeg);
  bus::Send(link.frame, frame);
}

}  // namespace conav::bench
