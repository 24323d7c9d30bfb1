#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <numbers>
#include <numeric>
#include <thread>

#include "bench/support/bench_program.h"
#include "common/bus/publisher.h"
#include "common/grid/visibility.h"
#include "common/msg/convert.h"
#include "common/runtime/clock.h"
#include "sim/config.h"
#include "sim/physics/camera.h"
#include "sim/world/world_spec.h"

namespace conav::bench {

/// What is played to the console: robots that drive eastwards through a square world, each in a row
/// of its own, and begin again in the west. A robot's place tells the time.
struct Drive {
  int robots = 16;       // 1..26: each has a letter of its own on the map
  int side = 150;        // cells; at least robots + 2
  double begin_s = 0.0;  // wall time at which they set out

  static constexpr double kCellSizeM = 2.0;
  static constexpr double kSpeedMps = 0.8;  // as a person drives them

  /// s until they begin again.
  double PeriodS() const { return (side - 2) * kCellSizeM / kSpeedMps; }
  /// x of a robot that begins.
  double WestM() const { return (1.0 - side / 2.0) * kCellSizeM; }
  /// s between `now_s` and the time at which a robot was at `x_m`.
  double AgeS(double x_m, double now_s) const {
    return std::remainder(now_s - begin_s - (x_m - WestM()) / kSpeedMps, PeriodS());
  }
};

/// "r1" for 0.
inline std::string RobotName(int robot) { return fmt::format("r{}", robot + 1); }

inline constexpr int kRoom = 10;       // cells from wall to wall
inline constexpr int kSightCells = 2;  // as far as a robot sees around itself
inline constexpr int kOneWrongIn = 9;  // cells of the operator's map

/// Rows from north to south, as evenly as they go.
inline int RowOf(const Drive& drive, int robot) {
  return 1 + robot * (drive.side - 2) / drive.robots;
}

inline bool IsRoomWall(Cell cell) {
  const auto is_door = [](int at) { return at % kRoom == kRoom / 2; };
  return (cell.row % kRoom == 0 && !is_door(cell.column)) ||
         (cell.column % kRoom == 0 && !is_door(cell.row));
}

/// Rooms with doors, and the robots' rows free.
inline OccupancyGrid TrueMap(const Drive& drive) {
  OccupancyGrid truth(drive.side, drive.side, Occupancy::kFree);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Cell cell = truth.CellAt(i);
    if (truth.OnBorder(cell) || IsRoomWall(cell)) truth[cell] = Occupancy::kOccupied;
  }
  for (int robot = 0; robot < drive.robots; ++robot) {
    for (int column = 1; column < drive.side - 1; ++column) {
      truth[{RowOf(drive, robot), column}] = Occupancy::kFree;
    }
  }
  return truth;
}

/// What the operator takes it for at first: some walls are missing, some are not there.
inline OccupancyGrid InitialMap(const OccupancyGrid& truth) {
  OccupancyGrid map = truth;
  for (std::size_t i = 0; i < map.size(); i += kOneWrongIn) {
    const Cell cell = map.CellAt(i);
    if (map.OnBorder(cell)) continue;
    map[cell] = map[cell] == Occupancy::kFree ? Occupancy::kOccupied : Occupancy::kFree;
  }
  return map;
}

/// One robot on its way: what it says at a time.
class DrivingRobot {
 public:
  DrivingRobot(const Drive& drive, const OccupancyGrid& truth, int robot)
      : drive_(drive),
        truth_(truth),
        view_(ViewThrough(CameraLens(), {}, 0.0, Drive::kCellSizeM)),
        seen_(truth.rows(), truth.columns(), Occupancy::kUnknown) {
    state_.world = "w1";
    state_.robot = RobotName(robot);
    state_.grid = {drive.side, drive.side, Drive::kCellSizeM};
    state_.goals_stamp = {1};
    state_.cell = {RowOf(drive, robot), 0};
    state_.position = state_.grid.CellToPosition(state_.cell);
    state_.path = {state_.cell};
    state_.goals_left = {{1, 1}, {drive.side - 2, 1}, {1, drive.side - 2}};
    state_.goals_total = 3;
    state_.command_outcome = CommandOutcome::kRunning;
  }

  /// `now_s`: wall time, not before the drive's begin. What it has seen grows with it.
  RobotState State(double now_s) {
    const double driven_s = now_s - drive_.begin_s;
    state_.stamp = SimTime::FromSeconds(driven_s);
    state_.position.x_m = drive_.WestM() + std::fmod(driven_s, drive_.PeriodS()) * Drive::kSpeedMps;
    const Cell cell{state_.cell.row, 1 + static_cast<int>((state_.position.x_m - drive_.WestM()) /
                                                          Drive::kCellSizeM)};
    if (cell != state_.cell) {
      ++state_.cell_moves;
      state_.cell = cell;
      state_.command_cell = cell + Cell{0, 1};
      state_.path.push_back(cell);
      See(cell);
    }
    return state_;
  }
  /// Of a camera, after State(); the next one in its order.
  Snapshot TakeSnapshot(const std::vector<std::uint8_t>& jpeg) {
    const CameraLens lens;
    Snapshot snapshot;
    snapshot.stamp = state_.stamp;
    snapshot.world = state_.world;
    snapshot.robot = state_.robot;
    snapshot.sequence_number = ++state_.snapshots;
    snapshot.grid = state_.grid;
    snapshot.cell = state_.cell;
    snapshot.position = state_.position;
    snapshot.horizontal_fov_rad = lens.horizontal_fov_rad;
    snapshot.width = static_cast<std::uint32_t>(lens.width);
    snapshot.height = static_cast<std::uint32_t>(lens.height);
    snapshot.jpeg = jpeg;
    snapshot.visible = view_.Cast(truth_, state_.cell);
    snapshot.path = std::exchange(state_.path, {state_.cell});
    snapshot.goals_left = state_.goals_left;
    ++state_.images;
    state_.image_bytes += jpeg.size();
    return snapshot;
  }
  /// What it has seen, if that is more than at the call before.
  bool HasNewMap() const { return map_is_new_; }
  MapUpdate Map() {
    map_is_new_ = false;
    state_.map_stamp = state_.stamp;
    return {state_.stamp, Drive::kCellSizeM, seen_};
  }

 private:
  void See(Cell cell) {
    for (int row = -kSightCells; row <= kSightCells; ++row) {
      for (int column = -kSightCells; column <= kSightCells; ++column) {
        const Cell near = cell + Cell{row, column};
        if (!seen_.Contains(near) || seen_[near] == truth_[near]) continue;
        seen_[near] = truth_[near];
        map_is_new_ = true;
      }
    }
  }

  const Drive& drive_;
  const OccupancyGrid& truth_;
  ViewCaster view_;
  OccupancyGrid seen_;
  RobotState state_;
  bool map_is_new_ = false;
};

inline constexpr int kSnapshots = 8;

template <class T>
T Checked(Result<T> result) {
  if (!result) throw StartupError("pictures of the camera: " + result.error().text);
  return std::move(result.value());
}

inline std::unique_ptr<sim::RobotWorld> MakeMaze() {
  const sim::WorldSpec spec = Checked(sim::MakeWorldSpec({}));
  sim::PhysicsWorld world;
  world.truth = spec.truth;
  world.wall_classes = spec.wall_classes;
  world.floor_classes = spec.floor_classes;
  world.robots = {{"r1", spec.starts.front(), 0.0}};
  return Checked(sim::RobotWorld::Create(std::move(world)));
}

/// JPEGs of the simulator's camera in a maze, in its usual size and quality. Throws StartupError.
inline std::vector<std::vector<std::uint8_t>> CameraSnapshots(int count) {
  const sim::CameraConfig config;
  const auto maze = MakeMaze();
  const auto camera = Checked(sim::Camera::Open(*maze, {config.width, config.height}));
  const Position start = maze->pose(0).position;
  std::vector<std::vector<std::uint8_t>> snapshots;
  for (int i = 0; i < count; ++i) {
    maze->Teleport(0, start, 2.0 * std::numbers::pi * i / count);
    snapshots.push_back(Checked(sim::EncodeJpeg(camera->Render(0), config.jpeg_quality)));
  }
  return snapshots;
}

struct LoadOptions {
  Drive drive;
  double state_hz = 20.0;
  double snapshot_hz = 2.0;

  /// A picture comes with each so many-th state of a robot: as near to `picture_hz` as that goes,
  /// with every state at most.
  int StatesPerSnapshot() const {
    return std::max(1, static_cast<int>(std::lround(state_hz / snapshot_hz)));
  }
};

/// Publishes what simulators of these robots would, until it is destroyed: state, map whenever a
/// cell is entered, and at `picture_hz` each a snapshot and a frame of the live view, with the same
/// JPEG. The robots do so one after the other, evenly over the period, as robots do that have
/// nothing to do with each other.
///
/// Threads: one of its own.
class Load {
 public:
  /// Begins with the world's initial map. `participant` outlives it.
  Load(bus::Participant& participant, const LoadOptions& options)
      : options_(options),
        truth_(TrueMap(options_.drive)),
        jpegs_(CameraSnapshots(kSnapshots)),
        initial_map_(participant, bus::kInitialMap, "w1") {
    for (int i = 0; i < options_.drive.robots; ++i) {
      robots_.push_back(std::make_unique<RobotLink>(participant, options_.drive, truth_, i));
    }
    bus::Send(initial_map_, ToMessage(MapUpdate{SimTime{}, Drive::kCellSizeM, InitialMap(truth_)}));
    thread_ = std::thread([this] { Run(); });
  }
  ~Load() {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    stopped_.notify_all();
    thread_.join();
  }
  Load(const Load&) = delete;
  Load& operator=(const Load&) = delete;

  /// s of processor time of its thread.
  double cpu_s() const { return cpu_s_; }
  /// How late it was with a state at most, in ms, since the call before.
  double TakeLatenessMs() { return lateness_ms_.exchange(0.0); }
  /// Of one, on average.
  std::size_t image_bytes() const {
    const auto add = [](std::size_t sum, const auto& jpeg) { return sum + jpeg.size(); };
    return std::accumulate(jpegs_.begin(), jpegs_.end(), std::size_t{0}, add) / jpegs_.size();
  }

 private:
  struct RobotLink {
    RobotLink(bus::Participant& participant, const Drive& drive, const OccupancyGrid& truth,
              int number)
        : number(number),
          robot(drive, truth, number),
          state(participant, bus::kRobotState, RobotName(number)),
          goals(participant, bus::kRobotGoals, RobotName(number)),
          map(participant, bus::kRobotMap, RobotName(number)),
          snapshot(participant, bus::kSnapshot, RobotName(number)),
          frame(participant, bus::kCameraImage, RobotName(number)),
          attention(participant, bus::kAttention, RobotName(number)) {}

    int number;
    DrivingRobot robot;
    bus::Publisher<conav_msgs::msg::RobotState> state;
    bus::Publisher<conav_msgs::msg::RobotGoals> goals;
    bus::Publisher<nav_msgs::msg::OccupancyGrid> map;
    bus::Publisher<conav_msgs::msg::Snapshot> snapshot;
    bus::Publisher<sensor_msgs::msg::CompressedImage> frame;
    /// Says nothing; without one the service would take the planner for gone.
    bus::Publisher<conav_msgs::msg::AttentionRequest> attention;
  };

  void Run() {
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
  /// False when it must end.
  bool WaitUntil(double wall_s) {
    const std::chrono::duration<double> left(wall_s - WallSeconds());
    std::unique_lock lock(mutex_);
    return !stopped_.wait_for(lock, left, [this] { return stop_; });
  }
  void Publish(RobotLink& link, std::uint64_t round, double due_s) {
    const auto states_per_snapshot = static_cast<std::uint64_t>(options_.StatesPerSnapshot());
    const auto number = static_cast<std::uint64_t>(link.number);
    const bool snapshots = (round + number) % states_per_snapshot == 0;
    const double now_s = WallSeconds();
    lateness_ms_ = std::max(lateness_ms_.load(), 1000.0 * (now_s - due_s));
    const RobotState state = link.robot.State(now_s);
    if (round == 0) bus::Send(link.goals, ToMessage(GoalsOf(state, 1.0)));
    bus::Send(link.state, ToMessage(state));
    if (link.robot.HasNewMap()) bus::Send(link.map, ToMessage(link.robot.Map()));
    if (!snapshots) return;
    const auto& jpeg = jpegs_[(round / states_per_snapshot + number) % jpegs_.size()];
    bus::Send(link.snapshot, ToMessage(link.robot.TakeSnapshot(jpeg)));
    sensor_msgs::msg::CompressedImage frame;
    frame.header().stamp(ToMessage(state.stamp));
    frame.header().frame_id("camera_optical_frame");
    frame.format("jpeg");
    frame.data(jpeg);
    bus::Send(link.frame, frame);
  }

  const LoadOptions options_;
  const OccupancyGrid truth_;
  const std::vector<std::vector<std::uint8_t>> jpegs_;
  std::vector<std::unique_ptr<RobotLink>> robots_;
  bus::Publisher<nav_msgs::msg::OccupancyGrid> initial_map_;
  std::atomic<double> cpu_s_ = 0.0;
  std::atomic<double> lateness_ms_ = 0.0;
  std::mutex mutex_;  // guards stop_
  std::condition_variable stopped_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace conav::bench
