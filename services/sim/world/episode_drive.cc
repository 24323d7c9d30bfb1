#include "sim/world/episode_drive.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/world/episode.h"

namespace conav::sim {
namespace {

/// Distance between the discs that sample a path; small compared with the margin of the body.
constexpr double kSampleM = 0.05;

/// Share of the path from `from` to `to` at which a coordinate passes `edge`.
double ShareUntil(double edge, double from, double to) { return (edge - from) / (to - from); }

}  // namespace

double DistanceToCell(const GridGeometry& geometry, Position position, Cell cell) {
  const Position centre = geometry.CellToPosition(cell);
  const double half = geometry.cell_size_m / 2.0;
  const double dx = std::max(std::abs(position.x_m - centre.x_m) - half, 0.0);
  const double dy = std::max(std::abs(position.y_m - centre.y_m) - half, 0.0);
  return std::hypot(dx, dy);
}

Position Ahead(Position from, double heading_rad, double distance_m) {
  return {from.x_m + distance_m * std::cos(heading_rad),
          from.y_m + distance_m * std::sin(heading_rad)};
}

std::vector<Cell> CellsSwept(const GridGeometry& geometry, Position from, Position to,
                             double radius_m) {
  const auto north_west = [&](Position at) {
    return geometry.PositionToCell({at.x_m - radius_m, at.y_m + radius_m});
  };
  const auto south_east = [&](Position at) {
    return geometry.PositionToCell({at.x_m + radius_m, at.y_m - radius_m});
  };
  // With a cell more on all sides, because of rounding.
  const Cell corner =
      north_west({std::min(from.x_m, to.x_m), std::max(from.y_m, to.y_m)}) - Cell{1, 1};
  const Cell end =
      south_east({std::max(from.x_m, to.x_m), std::min(from.y_m, to.y_m)}) + Cell{2, 2};
  Grid<std::uint8_t> listed(end.row - corner.row, end.column - corner.column, 0);
  std::vector<Cell> cells;
  const double length = std::hypot(to.x_m - from.x_m, to.y_m - from.y_m);
  const int samples = static_cast<int>(std::ceil(length / kSampleM));
  for (int i = 0; i <= samples; ++i) {
    const double share = i == 0 ? 0.0 : static_cast<double>(i) / samples;
    const Position at{from.x_m + share * (to.x_m - from.x_m),
                      from.y_m + share * (to.y_m - from.y_m)};
    const Cell first = north_west(at);
    const Cell last = south_east(at);
    for (int row = first.row; row <= last.row; ++row) {
      for (int column = first.column; column <= last.column; ++column) {
        const Cell cell{row, column};
        if (listed[cell - corner] != 0 || DistanceToCell(geometry, at, cell) >= radius_m) continue;
        listed[cell - corner] = 1;
        cells.push_back(cell);
      }
    }
  }
  return cells;
}

std::vector<Cell> CellsEntered(const GridGeometry& geometry, Position from, Position to) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  std::vector<Cell> cells;
  Cell cell = geometry.PositionToCell(from);
  const Cell last = geometry.PositionToCell(to);
  while (cell != last) {
    const Position centre = geometry.CellToPosition(cell);
    const double half = geometry.cell_size_m / 2.0;
    const int east = last.column > cell.column ? 1 : -1;
    const int south = last.row > cell.row ? 1 : -1;
    const double along_row = last.column == cell.column
                                 ? kNever
                                 : ShareUntil(centre.x_m + east * half, from.x_m, to.x_m);
    const double along_column =
        last.row == cell.row ? kNever : ShareUntil(centre.y_m - south * half, from.y_m, to.y_m);
    cell = along_row <= along_column ? cell + Cell{0, east} : cell + Cell{south, 0};
    cells.push_back(cell);
  }
  return cells;
}

bool Episode::IsOnWay(int robot) const {
  constexpr double kDetourM = 0.02;
  const Position at = physics_.pose(robot).position;
  const Position from = physics_.geometry().CellToPosition(At(robot).state.cell);
  const Position to = physics_.geometry().CellToPosition(At(robot).waypoints.front());
  return Distance(from, at) + Distance(at, to) < Distance(from, to) + kDetourM;
}

// The low-level actions of Episode, which move robots freely between the centres of cells.

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
  const DriveSpeeds speeds = SpeedsOf(record.gate.command().drive);
  const RobotPose pose = physics_.pose(robot);
  const Position reach = Ahead(pose.position, pose.heading_rad,
                               DriveReach(pose, speeds, physics_.world().top_speed_mps));
  // Braking and turning stay within what the previous action was allowed.
  if (speeds.forward_mps == 0.0 || MayDrive(robot, reach)) {
    physics_.DriveStep(robot, speeds);
  } else {
    physics_.DriveStep(robot, {});
  }
}

double Episode::BodyRadius() const {
  return options_.open ? options_.robot_radius_m + kBodyRadiusM - kBallRadiusM : kBodyRadiusM;
}

double Episode::BrakingWay(int robot) const {
  return DriveReach(physics_.pose(robot), {}, physics_.world().top_speed_mps);
}

bool Episode::MayDrive(int robot, Position reach) {
  RobotRecord& record = At(robot);
  const OccupancyGrid& truth = physics_.world().truth;
  const GridGeometry& geometry = physics_.geometry();
  const Position from = record.position;
  const std::vector<Cell> cells = CellsSwept(geometry, from, reach, BodyRadius());
  const auto fail = [&](CommandOutcome outcome, Cell cell, std::string detail) {
    record.drive_outcome = outcome;
    record.drive_detail = std::move(detail);
    record.state.command_cell = cell;
    return false;
  };
  for (const Cell cell : cells) {
    // Moving away from a cell that is too close is allowed.
    const bool nearer =
        DistanceToCell(geometry, reach, cell) < DistanceToCell(geometry, from, cell);
    if (!truth.Contains(cell)) {
      if (nearer) return fail(CommandOutcome::kBlocked, record.state.cell, "the map ends here");
    } else if (truth[cell] == Occupancy::kOccupied) {
      if (!nearer) continue;
      Observe(robot, cell);
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
  const Cell before = record.state.cell;
  for (const Cell cell : CellsEntered(geometry, record.position, pose.position)) {
    // The axis cut a corner into a wall or another robot's cell.
    if (!truth.Contains(cell) || truth[cell] == Occupancy::kOccupied ||
        ReservedByAnother(robot, cell)) {
      continue;
    }
    if (cell == record.state.cell) continue;
    if (!options_.open) {
      Arrive(robot, cell);
      continue;
    }
    record.state.cell = cell;
    record.state.path.push_back(cell);
  }
  if (options_.open && record.state.cell != before) Observe(robot);
  record.position = pose.position;
  const Position rest = Ahead(pose.position, pose.heading_rad, BrakingWay(robot));
  std::vector<Cell> cells = CellsSwept(geometry, pose.position, rest, BodyRadius());
  std::erase_if(cells, [&](Cell cell) {
    return cell != record.state.cell && ReservedByAnother(robot, cell);
  });
  record.reserved = std::move(cells);
}

void Episode::EndDrive(int robot) {
  RobotRecord& record = At(robot);
  TrackCells(robot);
  record.gate.End(record.drive_outcome, record.drive_detail);
  record.coasting = physics_.motion_status(robot) == MotionStatus::kRunning;
}

}  // namespace conav::sim
