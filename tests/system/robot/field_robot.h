#pragma once

#include <chrono>
#include <cmath>
#include <vector>

#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/msg/convert.h"
#include "robot/command_gate.h"

namespace conav::test {

/// A driver that is not the simulator: a robot that drives straight at 4 m/s through a hall of 8 x 12
/// cells of 0.5 m with a wall in it, whose south-west corner is (100, -50). It keeps no goals.
class FieldRobot {
 public:
  explicit FieldRobot(const bus::ParticipantOptions& options)
      : participant_("driver", options),
        initial_map_(participant_, bus::kInitialMap, "w1"),
        map_(participant_, bus::kRobotMap, "r1"),
        camera_info_(participant_, bus::kCameraInfo, "r1"),
        states_(participant_, bus::kRobotState, "r1"),
        commands_(participant_, bus::kRobotCommand, "r1"),
        stops_(participant_, bus::kStopOrder, "r1") {
    MapUpdate map{{1}, 0.5, OccupancyGrid(8, 12, Occupancy::kFree), grid_.middle};
    for (std::size_t i = 0; i < map.cells.size(); ++i) {
      const Cell cell = map.cells.CellAt(i);
      const bool wall = map.cells.OnBorder(cell) || (cell.column == 6 && cell.row < 6);
      if (wall) map.cells[cell] = Occupancy::kOccupied;
    }
    bus::Send(initial_map_, ToMessage(map));
    bus::Send(map_, ToMessage(map));
    sensor_msgs::msg::CameraInfo camera;
    camera.width(320);
    camera.height(192);
    camera.k({114.4, 0.0, 160.0, 0.0, 114.4, 96.0, 0.0, 0.0, 1.0});
    bus::Send(camera_info_, camera);
    place_ = grid_.CellToPosition({1, 1});
    cell_ = {1, 1};
    path_ = {cell_};
  }

  const GridGeometry& grid() const { return grid_; }
  bus::Participant& participant() { return participant_; }

  /// 0.05 s of its time.
  void Step() {
    now_ = now_ + std::chrono::milliseconds(50);
    for (const auto& order : stops_.TakeValid(kToDomain)) gate_.Receive(order);
    for (const auto& command : commands_.TakeValid(kToDomain)) {
      const auto admission = gate_.Receive(command, now_);
      if (!admission || *admission != robot::CommandGate::Admission::kStarted) continue;
      if (command.kind == CommandKind::kMove) continue;
      gate_.End(command.kind == CommandKind::kStop ? CommandOutcome::kDone
                                                   : CommandOutcome::kRefused);
    }
    gate_.EndIfExpired(now_);
    if (gate_.active()) Drive();
    Publish();
    participant_.Wait(std::chrono::milliseconds(10));
  }
  /// Until `done`, a minute at most.
  template <class Done>
  bool StepUntil(const Done& done) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!done() && std::chrono::steady_clock::now() < deadline) Step();
    return done();
  }
  bool IsIn(Position place) const {
    return cell_ == grid_.PositionToCell(place) && !gate_.active();
  }

 private:
  void Drive() {
    const Position to = gate_.command().path.back();
    const double left_m = std::hypot(to.x_m - place_.x_m, to.y_m - place_.y_m);
    const double step_m = std::min(0.2, left_m);
    if (left_m > 0.0) {
      place_.x_m += step_m * (to.x_m - place_.x_m) / left_m;
      place_.y_m += step_m * (to.y_m - place_.y_m) / left_m;
    }
    if (left_m - step_m > gate_.command().tolerance_m) return;
    cell_ = grid_.PositionToCell(place_);
    path_.push_back(cell_);
    ++moves_;
    gate_.End(CommandOutcome::kDone);
  }
  void Publish() {
    RobotState state{.stamp = now_,
                     .world = "w1",
                     .robot = "r1",
                     .grid = grid_,
                     .cell = cell_,
                     .position = place_,
                     .path = path_,
                     .cell_moves = moves_,
                     .map_stamp = {1}};
    gate_.Report(state);
    bus::Send(states_, ToMessage(state));
  }

  GridGeometry grid_{8, 12, 0.5, {100.0 + 3.0, -50.0 + 2.0}};
  robot::CommandGate gate_{"r1"};
  SimTime now_{1};
  Position place_;
  Cell cell_;
  std::vector<Cell> path_;
  std::uint64_t moves_ = 0;
  bus::Participant participant_;
  bus::Publisher<nav_msgs::msg::OccupancyGrid> initial_map_;
  bus::Publisher<nav_msgs::msg::OccupancyGrid> map_;
  bus::Publisher<sensor_msgs::msg::CameraInfo> camera_info_;
  bus::Publisher<conav_msgs::msg::RobotState> states_;
  bus::Subscriber<conav_msgs::msg::RobotCommand> commands_;
  bus::Subscriber<conav_msgs::msg::StopOrder> stops_;
};

}  // namespace conav::test
