#include "sim/world/episode.h"

#include <algorithm>
#include <cmath>

#include "common/grid/visibility.h"

namespace conav::sim {
namespace {

/// A robot this close to its cell's centre starts a move or a view from its current position.
constexpr double kCentredM = 0.15;

}  // namespace

Episode::Episode(RobotWorld& physics, EpisodeOptions options)
    : physics_(physics), options_(std::move(options)) {
  const auto count = static_cast<std::size_t>(physics.robot_count());
  DEMAND(options_.goals.size() == count, options_.goals.size(), count);
  robots_.resize(count);
  const OccupancyGrid& truth = physics.world().truth;
  for (int robot = 0; robot < robot_count(); ++robot) {
    const auto index = static_cast<std::size_t>(robot);
    RobotRecord& record = At(robot);
    const Cell start = physics.world().robots[index].start;
    record.state.world = options_.world;
    record.state.robot = physics.world().robots[index].name;
    record.state.cell = start;
    record.state.path = {start};
    record.state.goals_left = options_.goals[index];
    record.state.goals_total = static_cast<std::uint32_t>(options_.goals[index].size());
    record.reserved = {start};
    record.position = physics.pose(robot).position;
    record.map.cell_size_m = physics.world().cell_size_m;
    record.map.cells = OccupancyGrid(truth.rows(), truth.columns(), Occupancy::kUnknown);
    Observe(robot);
  }
}

RobotRecord& Episode::At(int robot) {
  DEMAND(robot >= 0 && robot < robot_count(), robot, robot_count());
  return robots_[static_cast<std::size_t>(robot)];
}

const RobotRecord& Episode::At(int robot) const {
  DEMAND(robot >= 0 && robot < robot_count(), robot, robot_count());
  return robots_[static_cast<std::size_t>(robot)];
}

Result<void> Episode::Accept(const RobotCommand& command) {
  const auto found = std::find_if(robots_.begin(), robots_.end(), [&](const RobotRecord& record) {
    return record.state.robot == command.robot;
  });
  if (found == robots_.end()) {
    return Fail(ErrorCode::kNotFound,
                fmt::format("robot = '{}' is not in world {}", command.robot, options_.world));
  }
  RobotRecord& record = *found;
  const RobotState& state = record.state;
  if (command.lease_epoch < state.lease_epoch) {
    return Fail(ErrorCode::kRefused,
                fmt::format("lease_epoch = {} is older than {}, the newest that {} has seen",
                            command.lease_epoch, state.lease_epoch, command.robot));
  }
  const bool same_lease = command.lease_epoch == state.lease_epoch;
  if (same_lease && command.sequence_number == state.command_sequence_number)
    return {};  // a repeat
  if (same_lease && command.sequence_number < state.command_sequence_number) {
    return Fail(ErrorCode::kRefused,
                fmt::format("sequence_number = {} is older than {}, the last that {} accepted",
                            command.sequence_number, state.command_sequence_number, command.robot));
  }
  record.command = command;
  Begin(static_cast<int>(found - robots_.begin()));
  return {};
}

void Episode::Begin(int robot) {
  RobotRecord& record = At(robot);
  const RobotCommand& command = record.command;
  record.state.lease_epoch = command.lease_epoch;
  record.state.command_sequence_number = command.sequence_number;
  record.state.command_cell = command.target;
  record.waypoints.clear();
  At(robot).turned = false;
  if (command.kind == CommandKind::kDrive) record.state.drive_order = command.drive_order;
  if (command.expires_at <= now()) {
    return Finish(robot, CommandOutcome::kExpired,
                  fmt::format("expired at {:.3f} s; the time is {:.3f} s",
                              command.expires_at.ToSeconds(), now().ToSeconds()));
  }
  record.active = true;
  record.coasting = false;
  record.state.command_outcome = CommandOutcome::kRunning;
  record.state.command_detail.clear();
  ++At(robot).version;
  switch (command.kind) {
    case CommandKind::kStop:
      return Finish(robot, CommandOutcome::kDone);
    case CommandKind::kMove:
      return BeginMove(robot);
    case CommandKind::kTransmitView:
      return BeginView(robot);
    case CommandKind::kDrive:
      return BeginDrive(robot);
  }
}

void Episode::BeginMove(int robot) {
  RobotRecord& record = At(robot);
  const Cell target = record.command.target;
  const OccupancyGrid& truth = physics_.world().truth;
  if (!truth.Contains(target) || !AreNeighbours(record.state.cell, target)) {
    return Finish(robot, CommandOutcome::kRefused,
                  fmt::format("target = {} is not a neighbour of {}", target, record.state.cell));
  }
  if (truth[target] == Occupancy::kOccupied) {
    Observe(robot);
    record.map.cells[target] = Occupancy::kOccupied;
    return Finish(robot, CommandOutcome::kBlocked, fmt::format("target = {} is a wall", target));
  }
  if (ReservedByAnother(robot, target)) {
    return Finish(robot, CommandOutcome::kOccupied,
                  fmt::format("another robot is in or near {}", target));
  }
  if (!Contains(record.reserved, target)) record.reserved.push_back(target);
  if (!Centred(robot)) record.waypoints.push_back(record.state.cell);
  record.waypoints.push_back(target);
  record.braking = false;
  physics_.MoveTo(robot, record.waypoints.front());
}

void Episode::BeginView(int robot) {
  RobotRecord& record = At(robot);
  record.braking = false;
  if (Centred(robot)) {
    physics_.TurnTo(robot, record.command.heading_rad);
  } else {
    record.waypoints.push_back(record.state.cell);
    physics_.MoveTo(robot, record.state.cell);
  }
}

bool Episode::active() const {
  return std::any_of(robots_.begin(), robots_.end(),
                     [](const RobotRecord& record) { return record.active || record.braking; });
}

void Episode::Step() {
  for (int robot = 0; robot < robot_count(); ++robot) {
    if (moving(robot)) ++At(robot).state.low_level_steps;
  }
  physics_.Step();
  for (int robot = 0; robot < robot_count(); ++robot) Advance(robot);
}

void Episode::Advance(int robot) {
  RobotRecord& record = At(robot);
  const bool running = physics_.motion_status(robot) == MotionStatus::kRunning;
  if (record.braking && !running) record.braking = false;
  if (record.coasting) {
    TrackCells(robot);
    record.coasting = running;
    ++At(robot).version;
  }
  if (!record.active) return;
  ++At(robot).version;
  if (record.command.kind == CommandKind::kDrive) return EndDrive(robot);
  if (now() >= record.command.expires_at) {
    return Finish(robot, CommandOutcome::kExpired,
                  fmt::format("not done by {:.3f} s", record.command.expires_at.ToSeconds()));
  }
  if (running) return;
  if (physics_.motion_status(robot) == MotionStatus::kStuck) {
    return Finish(robot, CommandOutcome::kBlocked, "stuck: something blocks the robot");
  }
  if (!record.waypoints.empty()) {
    const Cell reached = record.waypoints.front();
    record.waypoints.pop_front();
    if (reached != record.state.cell) {
      Arrive(robot, reached);
    } else {
      record.reserved = {reached};
      record.reserved.insert(record.reserved.end(), record.waypoints.begin(),
                             record.waypoints.end());
    }
    if (!record.waypoints.empty()) return physics_.MoveTo(robot, record.waypoints.front());
    if (record.command.kind == CommandKind::kMove) return Finish(robot, CommandOutcome::kDone);
    return physics_.TurnTo(robot, record.command.heading_rad);
  }
  At(robot).turned = record.command.kind == CommandKind::kTransmitView;
}

void Episode::Arrive(int robot, Cell cell) {
  RobotRecord& record = At(robot);
  record.state.cell = cell;
  record.state.path.push_back(cell);
  record.reserved = {cell};
  ++record.state.cell_moves;
  Observe(robot);
  ClaimGoal(robot, cell);
}

void Episode::Finish(int robot, CommandOutcome outcome, std::string detail) {
  RobotRecord& record = At(robot);
  record.state.command_outcome = outcome;
  record.state.command_detail = std::move(detail);
  record.active = false;
  record.waypoints.clear();
  At(robot).turned = false;
  ++At(robot).version;
  // A coasting robot brakes when time advances.
  const bool running = physics_.motion_status(robot) == MotionStatus::kRunning;
  if (running && !record.coasting) Halt(robot);
}

void Episode::Halt(int robot) {
  RobotRecord& record = At(robot);
  physics_.Halt(robot);
  record.braking = true;
  // It may stand between two cells, both still reserved; the axis decides which one it is in.
  const Cell cell = physics_.cell(robot);
  if (cell != record.state.cell && Contains(record.reserved, cell)) {
    const std::vector<Cell> reserved = record.reserved;
    Arrive(robot, cell);
    record.reserved = reserved;
  }
}

void Episode::Observe(int robot) {
  RobotRecord& record = At(robot);
  const VisibleCells seen =
      CastRange(physics_.world().truth, record.state.cell, options_.observation_distance_cells);
  for (const Cell cell : seen.free) record.map.cells[cell] = Occupancy::kFree;
  for (const Cell cell : seen.walls) record.map.cells[cell] = Occupancy::kOccupied;
  // Strictly increasing, so that each map has its own stamp even if no time has passed.
  record.map.stamp = std::max(now(), SimTime{record.map.stamp.nanoseconds + 1});
  record.state.map_stamp = record.map.stamp;
}

void Episode::ClaimGoal(int robot, Cell cell) {
  RobotRecord& record = At(robot);
  if (!Contains(record.state.goals_left, cell)) return;
  record.state.goals_reached.push_back(cell);
  for (int other = 0; other < robot_count(); ++other) {
    if (other != robot && !options_.shared_goals) continue;
    std::erase(At(other).state.goals_left, cell);
    ++At(other).version;
  }
  const auto& goals = physics_.world().goals;
  const bool wanted = std::any_of(robots_.begin(), robots_.end(), [&](const RobotRecord& other) {
    return Contains(other.state.goals_left, cell);
  });
  for (std::size_t goal = 0; goal < goals.size(); ++goal) {
    if (goals[goal].cell == cell && !wanted) physics_.SetGoalVisible(static_cast<int>(goal), false);
  }
}

bool Episode::ReservedByAnother(int robot, Cell cell) const {
  for (int other = 0; other < robot_count(); ++other) {
    if (other != robot && Contains(At(other).reserved, cell)) return true;
  }
  return false;
}

bool Episode::Centred(int robot) const {
  const Position at = physics_.pose(robot).position;
  const Position centre = physics_.geometry().CellToPosition(At(robot).state.cell);
  return std::hypot(at.x_m - centre.x_m, at.y_m - centre.y_m) < kCentredM;
}

std::vector<int> Episode::snapshots_due() const {
  std::vector<int> due;
  for (int robot = 0; robot < robot_count(); ++robot) {
    if (At(robot).turned) due.push_back(robot);
  }
  return due;
}

Snapshot Episode::MakeSnapshot(int robot) {
  RobotRecord& record = At(robot);
  Snapshot snapshot;
  snapshot.stamp = now();
  snapshot.world = record.state.world;
  snapshot.robot = record.state.robot;
  snapshot.sequence_number = ++record.state.snapshots;
  snapshot.cell = record.state.cell;
  snapshot.heading_rad = physics_.pose(robot).heading_rad;
  snapshot.path = record.state.path;
  snapshot.goals_left = record.state.goals_left;
  record.state.path = {record.state.cell};
  return snapshot;
}

Snapshot Episode::CompleteView(int robot, std::size_t jpeg_bytes) {
  DEMAND(At(robot).turned, robot);
  Snapshot snapshot = MakeSnapshot(robot);
  snapshot.heading_rad = At(robot).command.heading_rad;
  CountFrame(robot, jpeg_bytes);
  Finish(robot, CommandOutcome::kDone);
  return snapshot;
}

Snapshot Episode::TakeStreamedSnapshot(int robot) {
  Snapshot snapshot = MakeSnapshot(robot);
  snapshot.streamed = true;
  return snapshot;
}

void Episode::CountFrame(int robot, std::size_t jpeg_bytes) {
  RobotRecord& record = At(robot);
  ++record.state.images;
  record.state.image_bytes += jpeg_bytes;
  ++At(robot).version;
}

SimTime Episode::now() const {
  constexpr std::int64_t kStepNs = 250'000'000;
  return {static_cast<std::int64_t>(physics_.steps()) * kStepNs};
}

bool Episode::moving(int robot) const {
  const RobotRecord& record = At(robot);
  return record.active || record.braking || record.coasting;
}

RobotState Episode::state(int robot) const {
  RobotState state = At(robot).state;
  state.stamp = now();
  const RobotPose pose = physics_.pose(robot);
  state.heading_rad = pose.heading_rad;
  state.position = pose.position;
  return state;
}

const MapUpdate& Episode::map(int robot) const { return At(robot).map; }

std::uint64_t Episode::state_version(int robot) const { return At(robot).version; }

}  // namespace conav::sim
