#include <algorithm>

#include "sim/episode/episode.h"
#include "sim/episode/swept_cells.h"

// Low-level actions: the part of Episode that moves robots freely between the centres of cells.
namespace conav::sim {
namespace {

bool Contains(const std::vector<Cell>& cells, Cell cell) {
  return std::find(cells.begin(), cells.end(), cell) != cells.end();
}

}  // namespace

DriveSpeeds Episode::SpeedsOf(DriveAction action) const {
  const DriveLimits& limits = options_.drive;
  switch (action) {
    case DriveAction::kForward:
      return {limits.forward_mps, 0.0};
    case DriveAction::kBackward:
      return {-limits.backward_mps, 0.0};
    case DriveAction::kTurnLeft:
      return {0.0, limits.turn_rps};
    case DriveAction::kTurnRight:
      return {0.0, -limits.turn_rps};
    case DriveAction::kStop:
      break;
  }
  return {};
}

void Episode::BeginDrive(int robot) {
  RobotRecord& record = At(robot);
  record.braking = false;
  record.drive_outcome = CommandOutcome::kDone;
  record.drive_detail.clear();
  record.state.command_cell = record.state.cell;
  record.position = physics_.pose(robot).position;
  const DriveSpeeds speeds = SpeedsOf(record.command.drive);
  const RobotPose pose = physics_.pose(robot);
  const Position reach = Ahead(pose.position, pose.heading_rad, DriveReach(pose, speeds));
  // Braking and turning end within what the action before was allowed.
  if (speeds.forward_mps == 0.0 || MayDrive(robot, reach)) {
    physics_.DriveStep(robot, speeds);
  } else {
    physics_.DriveStep(robot, {});
  }
}

bool Episode::MayDrive(int robot, Position reach) {
  RobotRecord& record = At(robot);
  const OccupancyGrid& truth = physics_.world().truth;
  const GridGeometry& geometry = physics_.geometry();
  const Position from = record.position;
  const std::vector<Cell> cells = CellsSwept(geometry, from, reach);
  const auto fail = [&](CommandOutcome outcome, Cell cell, std::string detail) {
    record.drive_outcome = outcome;
    record.drive_detail = std::move(detail);
    record.state.command_cell = cell;
    return false;
  };
  for (const Cell cell : cells) {
    // Away from what is too near already is allowed.
    const bool nearer =
        DistanceToCell(geometry, reach, cell) < DistanceToCell(geometry, from, cell);
    if (!truth.Contains(cell)) {
      if (nearer) return fail(CommandOutcome::kBlocked, record.state.cell, "the world ends here");
    } else if (truth[cell] == Occupancy::kOccupied) {
      if (!nearer) continue;
      Observe(robot);
      record.map.cells[cell] = Occupancy::kOccupied;
      return fail(CommandOutcome::kBlocked, cell, fmt::format("{} is a wall", cell));
    } else if (ReservedByAnother(robot, cell)) {
      if (!nearer && Contains(record.reserved, cell)) continue;
      return fail(CommandOutcome::kOccupied, cell,
                  fmt::format("another robot is in or near {}", cell));
    }
  }
  for (const Cell cell : cells) {
    if (!Contains(record.reserved, cell)) record.reserved.push_back(cell);
  }
  return true;
}

void Episode::TrackCells(int robot) {
  RobotRecord& record = At(robot);
  const GridGeometry& geometry = physics_.geometry();
  const RobotPose pose = physics_.pose(robot);
  const OccupancyGrid& truth = physics_.world().truth;
  for (const Cell cell : CellsEntered(geometry, record.position, pose.position)) {
    // The axis passed a corner: what it cut off is a wall, or another robot's.
    if (!truth.Contains(cell) || truth[cell] == Occupancy::kOccupied ||
        ReservedByAnother(robot, cell)) {
      continue;
    }
    if (cell != record.state.cell) Arrive(robot, cell);
  }
  record.position = pose.position;
  const Position rest = Ahead(pose.position, pose.heading_rad, DriveReach(pose, {}));
  std::vector<Cell> cells = CellsSwept(geometry, pose.position, rest);
  std::erase_if(cells, [&](Cell cell) {
    return cell != record.state.cell && ReservedByAnother(robot, cell);
  });
  record.reserved = std::move(cells);
}

void Episode::EndDrive(int robot) {
  RobotRecord& record = At(robot);
  TrackCells(robot);
  record.active = false;
  record.coasting = physics_.motion_status(robot) == MotionStatus::kRunning;
  record.state.command_outcome = record.drive_outcome;
  record.state.command_detail = record.drive_detail;
}

}  // namespace conav::sim
