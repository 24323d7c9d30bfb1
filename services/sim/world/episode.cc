#include "sim/world/episode.h"

#include <algorithm>
#include <cmath>

#include "common/grid/visibility.h"
#include "sim/world/episode_drive.h"

namespace conav::sim {
namespace {

/// A robot this close to its cell's centre starts a move or a view from its current position.
constexpr double kCentredM = 0.15;

}  // namespace

PhysicsWorld PhysicsOf(const WorldSpec& spec, const std::vector<std::string>& robots) {
  PhysicsWorld world;
  world.truth = spec.truth;
  world.open = spec.open;
  world.heights = spec.heights;
  world.wall_classes = spec.wall_classes;
  world.floor_classes = spec.floor_classes;
  world.cell_size_m = spec.cell_size_m;
  for (const Door& door : spec.doors) world.doors.push_back(door.cell);
  for (std::size_t i = 0; i < robots.size(); ++i) {
    world.robots.push_back({robots[i], spec.starts[i], spec.start_heading_rad});
    if (spec.shared_goals && i > 0) continue;
    for (const Cell cell : spec.goals[i]) {
      const auto color = spec.shared_goals ? world.goals.size() : i;
      world.goals.push_back({cell, static_cast<int>(color)});
    }
  }
  return world;
}

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
    record.gate = robot::CommandGate(record.state.robot);
    record.state.grid = physics.geometry();
    record.state.cell = start;
    record.state.path = {start};
    if (options_.keeps_goals) {
      record.state.goals_left = options_.goals[index];
      record.state.goals_total = static_cast<std::uint32_t>(options_.goals[index].size());
      record.state.goals_stamp = SimTime{1};  // 0 says that the robot does not keep its goals
    }
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

int Episode::Find(const std::string& robot) const {
  const auto found = std::ranges::find(
      robots_, robot, [](const RobotRecord& record) { return record.state.robot; });
  return found == robots_.end() ? -1 : static_cast<int>(found - robots_.begin());
}

Result<void> Episode::Accept(const RobotCommand& command) {
  const int robot = Find(command.robot);
  if (robot < 0) {
    return Fail(ErrorCode::kNotFound,
                fmt::format("robot = '{}' is not in world {}", command.robot, options_.world));
  }
  using Admission = robot::CommandGate::Admission;
  const auto admission = At(robot).gate.Receive(command, now());
  if (!admission) return tl::unexpected(admission.error());
  if (*admission != Admission::kRepeated) Begin(robot, *admission == Admission::kStarted);
  return {};
}

void Episode::Accept(const StopOrder& order) {
  const int robot = Find(order.robot);
  if (robot < 0) return;
  const bool ended = At(robot).gate.Receive(order);
  ++At(robot).version;
  if (ended) Rest(robot);
}

void Episode::Begin(int robot, bool started) {
  RobotRecord& record = At(robot);
  const RobotCommand& command = record.gate.command();
  record.state.command_cell = command.path.empty()
                                  ? record.state.cell
                                  : physics_.geometry().PositionToCell(command.path.back());
  if (!started) return Rest(robot);
  record.waypoints.clear();
  record.places.clear();
  record.turned = false;
  record.coasting = false;
  ++record.version;
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
  if (options_.open) return BeginOpenMove(robot);
  RobotRecord& record = At(robot);
  if (std::string why = CheckWay(robot); !why.empty()) {
    return Finish(robot, CommandOutcome::kRefused, std::move(why));
  }
  for (const Position place : record.gate.command().path) {
    record.waypoints.push_back(physics_.geometry().PositionToCell(place));
  }
  if (!Centred(robot) && !IsOnWay(robot)) record.waypoints.push_front(record.state.cell);
  BeginLeg(robot);
}

std::string Episode::CheckWay(int robot) const {
  const RobotCommand& command = At(robot).gate.command();
  const GridGeometry& geometry = physics_.geometry();
  if (command.tolerance_m < kPlaceToleranceM) {
    return fmt::format("tolerance = {} m is below the {} m that the robot can keep",
                       command.tolerance_m, kPlaceToleranceM);
  }
  Cell from = At(robot).state.cell;
  for (const Position place : command.path) {
    const Cell cell = geometry.PositionToCell(place);
    const bool reaches = cell == from || AreNeighbours(from, cell);
    if (!physics_.world().truth.Contains(cell) || !reaches) {
      return fmt::format("path: {} is not a neighbour of {}", cell, from);
    }
    const Position middle = geometry.CellToPosition(cell);
    if (std::hypot(place.x_m - middle.x_m, place.y_m - middle.y_m) > command.tolerance_m) {
      return fmt::format("path: ({}, {}) m is more than {} m from the middle of {}", place.x_m,
                         place.y_m, command.tolerance_m, cell);
    }
    from = cell;
  }
  return {};
}

void Episode::BeginLeg(int robot) {
  RobotRecord& record = At(robot);
  const Cell target = record.waypoints.front();
  const Cell ahead =
      target == record.state.cell && record.waypoints.size() > 1 ? record.waypoints[1] : target;
  const GridGeometry& geometry = physics_.geometry();
  if (physics_.world().truth[ahead] == Occupancy::kOccupied) {
    Observe(robot, ahead);
    record.state.command_cell = ahead;
    return Finish(robot, CommandOutcome::kBlocked, fmt::format("{} is a wall", ahead));
  }
  record.gate.SetHeldByOthers(HeldByOthers(robot));
  if (!record.gate.IsClear(geometry.CellToPosition(record.state.cell),
                           geometry.CellToPosition(ahead), geometry.cell_size_m / 2.0)) {
    record.state.command_cell = ahead;
    return Finish(robot, CommandOutcome::kOccupied,
                  fmt::format("another robot is in or near {}", ahead));
  }
  if (!Contains(record.reserved, ahead)) record.reserved.push_back(ahead);
  record.braking = false;
  physics_.MoveTo(robot, target);
}

void Episode::BeginView(int robot) {
  RobotRecord& record = At(robot);
  record.braking = false;
  if (Centred(robot)) {
    physics_.TurnTo(robot, record.gate.command().heading_rad);
  } else {
    record.waypoints.push_back(record.state.cell);
    physics_.MoveTo(robot, record.state.cell);
  }
}

bool Episode::active() const {
  return std::any_of(robots_.begin(), robots_.end(), [](const RobotRecord& record) {
    return record.gate.active() || record.braking;
  });
}

void Episode::Step(const std::function<void(int)>& between) {
  for (int robot = 0; robot < robot_count(); ++robot) {
    if (moving(robot)) ++At(robot).state.low_level_steps;
    At(robot).state.position = physics_.pose(robot).position;
  }
  physics_.Step(between);
  for (int robot = 0; robot < robot_count(); ++robot) {
    RobotState& state = At(robot).state;
    const Position at = physics_.pose(robot).position;
    if (moving(robot)) {
      state.distance_m += std::hypot(at.x_m - state.position.x_m, at.y_m - state.position.y_m);
    }
  }
  for (int robot = 0; robot < robot_count(); ++robot) Advance(robot);
  CloseDoors();
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
  if (!record.gate.active()) return;
  ++At(robot).version;
  if (record.gate.command().kind == CommandKind::kDrive) return EndDrive(robot);
  if (record.gate.EndIfExpired(now())) return Rest(robot);
  if (!record.places.empty()) return AdvanceOpen(robot);
  if (running) return;
  if (physics_.motion_status(robot) == MotionStatus::kStuck) {
    return Finish(robot, CommandOutcome::kBlocked, "stuck: something blocks the robot");
  }
  if (!record.waypoints.empty()) {
    const Cell reached = record.waypoints.front();
    record.waypoints.pop_front();
    if (reached != record.state.cell) {
      Arrive(robot, reached);
      if (!record.waypoints.empty()) return BeginLeg(robot);
    } else {
      record.reserved = {reached};
      if (!record.waypoints.empty()) record.reserved.push_back(record.waypoints.front());
    }
    if (!record.waypoints.empty()) return physics_.MoveTo(robot, record.waypoints.front());
    return TurnOrFinish(robot);
  }
  At(robot).turned = record.gate.command().kind == CommandKind::kTransmitView;
  if (!At(robot).turned) Finish(robot, CommandOutcome::kDone);
}

void Episode::TurnOrFinish(int robot) {
  const RobotCommand& command = At(robot).gate.command();
  if (command.kind == CommandKind::kTransmitView) {
    physics_.TurnTo(robot, command.heading_rad);
  } else if (command.arrival_heading_rad) {
    physics_.TurnTo(robot, *command.arrival_heading_rad);
  } else {
    Finish(robot, CommandOutcome::kDone);
  }
}

void Episode::Arrive(int robot, Cell cell) {
  RobotRecord& record = At(robot);
  record.state.cell = cell;
  robot::Extend(record.state.path, cell);
  record.reserved = {cell};
  ++record.state.cell_moves;
  Observe(robot);
  ClaimGoal(robot, cell);
}

void Episode::CloseDoors() {
  int moves = 0;
  for (const RobotRecord& record : robots_) moves += static_cast<int>(record.state.cell_moves);
  for (int door = 0; door < static_cast<int>(options_.doors.size()); ++door) {
    const Cell cell = options_.doors[static_cast<std::size_t>(door)].cell;
    const bool is_held = std::ranges::any_of(robots_, [&](const RobotRecord& record) {
      return record.state.cell == cell || Contains(record.reserved, cell);
    });
    if (moves < options_.doors[static_cast<std::size_t>(door)].after_moves || is_held ||
        std::ranges::count(closed_, door) > 0)
      continue;
    physics_.CloseDoor(door);
    closed_.push_back(door);
    for (int robot = 0; robot < robot_count(); ++robot) Observe(robot);
  }
}

void Episode::Finish(int robot, CommandOutcome outcome, std::string detail) {
  At(robot).gate.End(outcome, std::move(detail));
  Rest(robot);
}

void Episode::Rest(int robot) {
  RobotRecord& record = At(robot);
  record.waypoints.clear();
  record.places.clear();
  record.turned = false;
  ++record.version;
  // A coasting robot brakes when time advances.
  const bool running = physics_.motion_status(robot) == MotionStatus::kRunning;
  if (!running || record.coasting) return;
  Halt(robot);
  // The cells that a robot off the middle of a cell enters until it stands are tracked.
  record.coasting = options_.open || record.gate.command().kind == CommandKind::kDrive;
}

void Episode::Halt(int robot) {
  RobotRecord& record = At(robot);
  physics_.Halt(robot);
  record.braking = true;
  if (options_.open) return;
  // It may stand between two cells, both still reserved; the axis decides which one it is in.
  const Cell cell = physics_.cell(robot);
  if (cell != record.state.cell && Contains(record.reserved, cell)) {
    const std::vector<Cell> reserved = record.reserved;
    Arrive(robot, cell);
    record.reserved = reserved;
  }
}

void Episode::Observe(int robot, std::optional<Cell> obstacle) {
  RobotRecord& record = At(robot);
  const VisibleCells seen =
      CastRange(physics_.world().truth, record.state.cell, options_.observation_distance_cells);
  bool changed = !options_.open;
  const auto note = [&](Cell cell, Occupancy occupancy) {
    changed = changed || record.map.cells[cell] != occupancy;
    record.map.cells[cell] = occupancy;
  };
  for (const Cell cell : seen.free) note(cell, Occupancy::kFree);
  for (const Cell cell : seen.walls) note(cell, Occupancy::kOccupied);
  if (obstacle) note(*obstacle, Occupancy::kOccupied);
  if (!changed) return;
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
    RobotState& state = At(other).state;
    if (std::erase(state.goals_left, cell) == 0) continue;
    // Strictly increasing, like that of maps.
    state.goals_stamp = std::max(now(), SimTime{state.goals_stamp.nanoseconds + 1});
    ++At(other).version;
  }
  HideUnwantedGoals();
}

void Episode::HideUnwantedGoals() {
  const auto& goals = physics_.world().goals;
  for (std::size_t goal = 0; goal < goals.size(); ++goal) {
    const bool is_wanted = std::ranges::any_of(robots_, [&](const RobotRecord& record) {
      return Contains(record.state.goals_left, goals[goal].cell);
    });
    if (!is_wanted) physics_.SetGoalVisible(static_cast<int>(goal), false);
  }
}

void Episode::Restore(Moment moment) {
  DEMAND(moment.robots.size() == robots_.size(), moment.robots.size(), robots_.size());
  physics_.SetSteps(moment.steps);
  for (int robot = 0; robot < robot_count(); ++robot) {
    RobotRecord& record = At(robot);
    auto& [state, map] = moment.robots[static_cast<std::size_t>(robot)];
    physics_.Teleport(robot, state.position, state.heading_rad);
    record.gate.Restore(state);
    record.state = std::move(state);
    record.state.grid = physics_.geometry();
    record.map.cells = std::move(map.cells);
    record.map.stamp = record.state.map_stamp;
    record.position = record.state.position;
    record.reserved =
        CellsSwept(physics_.geometry(), record.position, record.position, BodyRadius());
    if (!Contains(record.reserved, record.state.cell)) record.reserved.push_back(record.state.cell);
    ++record.version;
  }
  if (options_.keeps_goals) HideUnwantedGoals();
  CloseDoors();
}

bool Episode::ReservedByAnother(int robot, Cell cell) const {
  for (int other = 0; other < robot_count(); ++other) {
    if (other != robot && Contains(At(other).reserved, cell)) return true;
  }
  return false;
}

std::vector<Position> Episode::HeldByOthers(int robot) const {
  std::vector<Position> places;
  for (int other = 0; other < robot_count(); ++other) {
    if (other == robot) continue;
    if (options_.open) {
      places.push_back(physics_.pose(other).position);
      if (!At(other).places.empty()) places.push_back(At(other).places.front());
      continue;
    }
    for (const Cell cell : At(other).reserved) {
      places.push_back(physics_.geometry().CellToPosition(cell));
    }
  }
  return places;
}

bool Episode::Centred(int robot) const {
  if (options_.open) return true;  // every place is as good
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
  snapshot.grid = record.state.grid;
  snapshot.cell = record.state.cell;
  snapshot.position = physics_.pose(robot).position;
  snapshot.heading_rad = physics_.pose(robot).heading_rad;
  snapshot.path = record.state.path;
  snapshot.goals_left = record.state.goals_left;
  record.state.path = {record.state.cell};
  return snapshot;
}

Snapshot Episode::CompleteView(int robot, std::size_t jpeg_bytes) {
  DEMAND(At(robot).turned, robot);
  Snapshot snapshot = MakeSnapshot(robot);
  snapshot.heading_rad = At(robot).gate.command().heading_rad;
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

void Episode::CountViewedFrame(int robot, std::size_t jpeg_bytes) {
  At(robot).state.camera_bytes += jpeg_bytes;
  ++At(robot).version;
}

SimTime Episode::now() const {
  constexpr std::int64_t kStepNs = 250'000'000;
  return {static_cast<std::int64_t>(physics_.steps()) * kStepNs};
}

bool Episode::moving(int robot) const {
  const RobotRecord& record = At(robot);
  return record.gate.active() || record.braking || record.coasting;
}

RobotState Episode::state(int robot) const {
  RobotState state = At(robot).state;
  state.stamp = now();
  At(robot).gate.Report(state);
  const RobotPose pose = physics_.pose(robot);
  state.heading_rad = pose.heading_rad;
  state.position = pose.position;
  state.speed_mps = pose.speed_mps;
  state.yaw_rate_rps = pose.yaw_rate_rps;
  return state;
}

const MapUpdate& Episode::map(int robot) const { return At(robot).map; }
std::uint64_t Episode::state_version(int robot) const { return At(robot).version; }

}  // namespace conav::sim
