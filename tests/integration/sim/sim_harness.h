#pragma once

#include <fmt/core.h>

#include <memory>
#include <string>
#include <vector>

#include "common/bus/in_memory_bus.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/msg/convert.h"
#include "common/runtime/random.h"
#include "common/service/robot_state_topics.h"
#include "sim/sim_service.h"

namespace conav::sim {

/// What a test receives of one robot, and how it commands it.
class RobotLink {
 public:
  RobotLink(bus::Participant& participant, const std::string& robot)
      : robot_(robot),
        state_(participant, robot),
        map_(participant, bus::kRobotMap, robot),
        snapshot_(participant, bus::kSnapshot, robot),
        odometry_(participant, bus::Sparse(bus::kOdometry), robot),
        frame_(participant, bus::kCameraImage, robot),
        command_(participant, bus::kRobotCommand, robot) {}

  /// Takes in what arrived.
  void Update() {
    for (auto& state : state_.TakeStamped()) states.push_back(std::move(state.value));
    for (auto& map : map_.TakeValid(kDomain)) maps.push_back(std::move(map));
    for (auto& snapshot : snapshot_.TakeValid(kDomain)) snapshots.push_back(std::move(snapshot));
    for (const auto& odometry : odometry_.Take()) {
      position = {odometry.pose().pose().position().x(), odometry.pose().pose().position().y()};
    }
    frames += static_cast<int>(frame_.Take().size());
  }

  /// A command of lease `epoch` with the next sequence number, in force for `valid_s`.
  RobotCommand Command(CommandKind kind, double valid_s = 60.0) {
    RobotCommand command;
    command.robot = robot_;
    command.sequence_number = ++sequence_number_;
    command.lease_epoch = epoch;
    command.kind = kind;
    command.expires_at = SimTime::FromSeconds(state().stamp.ToSeconds() + valid_s);
    return command;
  }
  RobotCommand Move(Cell target, double valid_s = 60.0) {
    RobotCommand command = Command(CommandKind::kMove, valid_s);
    command.path = {state().grid.CellToPosition(target)};
    command.tolerance_m = 0.1;
    return command;
  }
  RobotCommand View(double heading_rad) {
    RobotCommand command = Command(CommandKind::kTransmitView);
    command.heading_rad = heading_rad;
    return command;
  }
  RobotCommand Key(DriveAction action) {
    RobotCommand command = Command(CommandKind::kDrive, 1.0);
    command.drive = action;
    command.drive_order = command.sequence_number;
    return command;
  }
  void Send(const RobotCommand& command) { (void)command_.Publish(ToMessage(command)); }

  const RobotState& state() const { return states.back(); }

  std::uint64_t epoch = 1;
  std::vector<RobotState> states;
  std::vector<MapUpdate> maps;
  std::vector<Snapshot> snapshots;
  Position position;
  int frames = 0;

 private:
  static constexpr auto kDomain = [](const auto& message) { return ToDomain(message); };

  std::string robot_;
  std::uint64_t sequence_number_ = 0;
  RobotStateTopics state_;
  bus::Subscriber<nav_msgs::msg::OccupancyGrid> map_;
  bus::Subscriber<conav_msgs::msg::Snapshot> snapshot_;
  bus::Subscriber<nav_msgs::msg::Odometry> odometry_;
  bus::Subscriber<sensor_msgs::msg::CompressedImage> frame_;
  bus::Publisher<conav_msgs::msg::RobotCommand> command_;
};

/// The sim service on an in-memory bus, turned by hand, with real MuJoCo and a clock that stands.
class SimHarness {
 public:
  explicit SimHarness(const SimConfig& config)
      : bus_(std::make_shared<bus::InMemoryBus>()),
        sim_(std::make_unique<bus::Participant>("sim", bus_)),
        peer_("test", bus_),
        service(*sim_, config, clock) {
    for (const std::string& robot : config.robots) {
      robots.push_back(std::make_unique<RobotLink>(peer_, robot));
    }
    Update();
  }

  /// One turn of the service's loop.
  bool Turn() {
    const bool stepped = service.Turn();
    Update();
    return stepped;
  }
  /// Turns until the service has nothing to do, at most 300 times.
  void Settle() {
    for (int turn = 0; turn < 300 && Turn(); ++turn) {
    }
  }
  /// Sends it to the first robot, settles, and tells what came of it.
  CommandOutcome Do(const RobotCommand& command) {
    robot().Send(command);
    Settle();
    return robot().state().command_outcome;
  }

  /// Commands the first robot into a free cell next to it.
  CommandOutcome Step() {
    return Do(robot().Move(NeighbourThatIs(Occupancy::kFree, robot().state().cell)));
  }
  /// A neighbour of `cell` that is free or a wall.
  Cell NeighbourThatIs(Occupancy what, Cell cell) {
    const OccupancyGrid truth = Truth();
    for (const Cell offset : kNeighbourOffsets) {
      if (truth[cell + offset] == what) return cell + offset;
    }
    throw std::runtime_error("no such neighbour");
  }

  /// The latched message of a topic that has one per world or robot.
  template <class T>
  T Latched(const bus::Topic<T>& topic, const std::string& entity) {
    bus::Subscriber<T> subscriber(peer_, topic, entity);
    std::vector<T> messages = subscriber.Take();
    if (messages.empty()) throw std::runtime_error("nothing latched on " + topic.NameFor(entity));
    return messages.back();
  }
  OccupancyGrid Truth() { return ToDomain(Latched(bus::kTruth, "w1")).value().cells; }

  RobotLink& robot(std::size_t index = 0) { return *robots[index]; }

  bus::Participant& peer() { return peer_; }

 private:
  void Update() {
    for (const auto& robot : robots) robot->Update();
  }

  std::shared_ptr<bus::InMemoryBus> bus_;
  std::unique_ptr<bus::Participant> sim_;
  bus::Participant peer_;

 public:
  FakeClock clock;
  SimService service;
  std::vector<std::unique_ptr<RobotLink>> robots;
};

/// conav13 with seed 9 and no camera.
inline SimConfig BlindConfig(int robots = 1) {
  SimConfig config;
  config.seed = 9;
  config.camera.mode = "none";
  config.robots.clear();
  for (int robot = 1; robot <= robots; ++robot) config.robots.push_back(fmt::format("r{}", robot));
  return config;
}

}  // namespace conav::sim
