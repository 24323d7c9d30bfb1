#include <algorithm>
#include <cmath>

#include "sim/world/episode.h"
#include "sim/world/episode_drive.h"

// The moves of Episode in open terrain, straight from place to place.

namespace conav::sim {
namespace {

/// What lies so far ahead of its body is checked even when the robot stands.
constexpr double kLookAheadM = 1.0;
/// A step in which a robot that touches an obstacle must get away from it.
constexpr double kSoonM = 0.05;
/// Kept free between two robots, besides their radii.
constexpr double kMarginM = 0.3;

/// The point `length_m` along the way, at most its end.
Position Along(Position from, Position to, double length_m) {
  const double way = Distance(from, to);
  const double share = way > length_m ? length_m / way : 1.0;
  return {from.x_m + share * (to.x_m - from.x_m), from.y_m + share * (to.y_m - from.y_m)};
}

}  // namespace

void Episode::BeginOpenMove(int robot) {
  RobotRecord& record = At(robot);
  const RobotCommand& command = record.gate.command();
  const auto refuse = [&](std::string why) {
    Finish(robot, CommandOutcome::kRefused, std::move(why));
  };
  if (command.tolerance_m < kSettledM) {
    return refuse(fmt::format("tolerance = {} m is below the {} m that the robot can keep",
                              command.tolerance_m, kSettledM));
  }
  for (const Position place : command.path) {
    if (!physics_.world().truth.Contains(physics_.geometry().PositionToCell(place))) {
      return refuse(fmt::format("path: ({}, {}) m lies off the map", place.x_m, place.y_m));
    }
  }
  record.places.assign(command.path.begin(), command.path.end());
  record.position = physics_.pose(robot).position;
  BeginOpenLeg(robot);
}

void Episode::BeginOpenLeg(int robot) {
  RobotRecord& record = At(robot);
  if (!IsWayOpen(robot)) return;
  record.braking = false;
  const bool last = record.places.size() == 1;
  physics_.DriveTo(robot, record.places.front(),
                   last ? kSettledM : record.gate.command().tolerance_m);
}

bool Episode::IsWayOpen(int robot) {
  RobotRecord& record = At(robot);
  const Position from = physics_.pose(robot).position;
  const double speed_mps = physics_.pose(robot).speed_mps;
  const GridGeometry& geometry = physics_.geometry();
  const OccupancyGrid& truth = physics_.world().truth;
  const double radius_m = options_.robot_radius_m;
  const double braking_m = std::abs(BrakingWay(robot)) + std::abs(speed_mps) * kControlStepS;
  const Position place = record.places.front();
  const Position ahead = Along(from, place, std::max(kLookAheadM, braking_m) + radius_m);
  const Position soon = Along(from, place, kSoonM);
  for (const Cell cell : CellsSwept(geometry, from, ahead, radius_m)) {
    if (truth.Contains(cell) && truth[cell] == Occupancy::kFree) continue;
    // From an obstacle that it touches it may drive away.
    const double now_m = DistanceToCell(geometry, from, cell);
    if (now_m < radius_m && DistanceToCell(geometry, soon, cell) >= now_m) continue;
    Observe(robot, truth.Contains(cell) ? std::optional(cell) : std::nullopt);
    record.state.command_cell = truth.Contains(cell) ? cell : record.state.cell;
    Finish(robot, CommandOutcome::kBlocked, fmt::format("an obstacle at {}", cell));
    return false;
  }
  record.gate.SetHeldByOthers(HeldByOthers(robot));
  if (record.gate.IsClear(from, ahead, 2.0 * radius_m + kMarginM)) {
    return true;
  }
  record.state.command_cell = geometry.PositionToCell(ahead);
  Finish(robot, CommandOutcome::kOccupied, "another robot is on the way");
  return false;
}

void Episode::AdvanceOpen(int robot) {
  RobotRecord& record = At(robot);
  TrackCells(robot);
  ClaimNearGoals(robot);
  switch (physics_.motion_status(robot)) {
    case MotionStatus::kRunning:
      IsWayOpen(robot);
      return;
    case MotionStatus::kStuck:
      return Finish(robot, CommandOutcome::kBlocked, "stuck: something blocks the robot");
    default:
      break;
  }
  record.places.pop_front();
  ++record.state.cell_moves;
  Observe(robot);
  record.places.empty() ? TurnOrFinish(robot) : BeginOpenLeg(robot);
}

void Episode::ClaimNearGoals(int robot) {
  const std::vector<Cell> goals = At(robot).state.goals_left;
  const Position place = physics_.pose(robot).position;
  for (const Cell goal : goals) {
    const Position middle = physics_.geometry().CellToPosition(goal);
    if (Distance(place, middle) > kOpenGoalM) continue;
    const std::vector<Cell> between = CellsEntered(physics_.geometry(), place, middle);
    const OccupancyGrid& truth = physics_.world().truth;
    const bool open = std::ranges::all_of(between, [&](Cell cell) {
      return truth.Contains(cell) && truth[cell] == Occupancy::kFree;
    });
    if (open) ClaimGoal(robot, goal);
  }
}

}  // namespace conav::sim
