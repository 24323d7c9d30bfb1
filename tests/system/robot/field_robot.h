#pragma once

#include <chrono>
#include <cmath>
#include <vector>

#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/grid/visibility.h"
#include "common/msg/convert.h"
#include "robot/command_gate.h"

namespace conav::test {

/// A driver that is not the simulator: a robot that drives straight at 4 m/s through a hall of 8 x 12
/// cells of 0.5 m with a wall in it, whose south-west corner is (100, -50). It keeps no goals; its
/// pictures have no pixels. The operator starts without the wall.
class FieldRobot {
 public:
  explicit FieldRobot(const bus::ParticipantOptions& options) : FieldRobot(options, {1}, {1, 1}) {}
  /// A driver that starts again: its time goes on and the robot stands where it stood.
  FieldRobot(const bus::ParticipantOptions& options, SimTime now, Cell cell)
      : now_(now),
        cell_(cell),
        participant_("driver", options),
        initial_map_(participant_, bus::kInitialMap, "w1"),
        map_(participant_, bus::kRobotMap, "r1"),
        camera_info_(participant_, bus::kCameraInfo, "r1"),
        states_(participant_, bus::kRobotState, "r1"),
        snapshots_(participant_, bus::kSnapshot, "r1"),
        commands_(participant_, bus::kRobotCommand, "r1"),
        stops_(participant_, bus::kStopOrder, "r1") {
    hall_.cells = OccupancyGrid(8, 12, Occupancy::kFree);
    for (std::size_t i = 0; i < hall_.cells.size(); ++i) {
      if (hall_.cells.OnBorder(hall_.cells.CellAt(i))) hall_.cells.values()[i] = kWall;
    }
    bus::Send(initial_map_, ToMessage(hall_));
    for (int row = 1; row < 6; ++row) hall_.cells[{row, 6}] = kWall;
    bus::Send(map_, ToMessage(hall_));
    sensor_msgs::msg::CameraInfo camera;
    camera.width(kWidth);
    camera.height(kHeight);
    camera.k({114.4, 0.0, 160.0, 0.0, 114.4, 96.0, 0.0, 0.0, 1.0});
    bus::Send(camera_info_, camera);
    place_ = grid_.CellToPosition(cell_);
    path_ = {cell_};
  }

  const GridGeometry& grid() const { return grid_; }
  SimTime now() const { return now_; }
  Cell cell() const { return cell_; }
  bool stopped() const { return gate_.stopped(); }
  std::uint64_t pictures() const { return pictures_; }

  /// 0.05 s of its time.
  void Step() {
    now_ = now_ + std::chrono::milliseconds(50);
    for (const auto& order : stops_.TakeValid(kToDomain)) gate_.Receive(order);
    for (const auto& command : commands_.TakeValid(kToDomain)) {
      const auto admission = gate_.Receive(command, now_);
      if (!admission || *admission != robot::CommandGate::Admission::kStarted) continue;
      if (command.kind == CommandKind::kMove) continue;
      if (command.kind == CommandKind::kTransmitView) {
        SendPicture();
        continue;
      }
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
  void SendPicture() {
    Snapshot picture{.stamp = now_,
                     .world = "w1",
                     .robot = "r1",
                     .sequence_number = ++pictures_,
                     .grid = grid_,
                     .cell = cell_,
                     .position = place_,
                     .heading_rad = gate_.command().heading_rad,
                     .width = kWidth,
                     .height = kHeight,
                     .path = path_};
    const CameraView view = ViewAt(cell_, picture.heading_rad, grid_.cell_size_m, kWidth, kHeight);
    picture.horizontal_fov_rad = view.horizontal_fov_rad;
    picture.visible = CastView(hall_.cells, view);
    bus::Send(snapshots_, ToMessage(picture));
    path_ = {cell_};
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
                     .snapshots = pictures_,
                     .map_stamp = {1}};
    gate_.Report(state);
    bus::Send(states_, ToMessage(state));
  }

  static constexpr Occupancy kWall = Occupancy::kOccupied;
  static constexpr int kWidth = 320;
  static constexpr int kHeight = 192;

  GridGeometry grid_{8, 12, 0.5, {100.0 + 3.0, -50.0 + 2.0}};
  MapUpdate hall_{{1}, 0.5, {}, grid_.middle};
  robot::CommandGate gate_{"r1"};
  SimTime now_;
  Position place_;
  Cell cell_;
  std::vector<Cell> path_;
  std::uint64_t moves_ = 0;
  std::uint64_t pictures_ = 0;
  bus::Participant participant_;
  bus::Publisher<nav_msgs::msg::OccupancyGrid> initial_map_;
  bus::Publisher<nav_msgs::msg::OccupancyGrid> map_;
  bus::Publisher<sensor_msgs::msg::CameraInfo> camera_info_;
  bus::Publisher<conav_msgs::msg::RobotState> states_;
  bus::Publisher<conav_msgs::msg::Snapshot> snapshots_;
  bus::Subscriber<conav_msgs::msg::RobotCommand> commands_;
  bus::Subscriber<conav_msgs::msg::StopOrder> stops_;
};

}  // namespace conav::test
