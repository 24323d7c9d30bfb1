#include "operator/simulated/steering.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/runtime/config.h"
#include "common/runtime/result.h"
#include "operator/simulated/path_planner.h"

namespace conav::operators {

void StreamMemory::Look(const SnapshotReaderParameters& parameters, const Snapshot& snapshot,
                        Random& random) {
  if (random.Chance(parameters.lapse_probability)) return;
  const auto distance = [&](Cell cell) {
    return std::hypot(cell.row - snapshot.cell.row, cell.column - snapshot.cell.column);
  };
  const auto noticed = [&](Cell cell) {
    return random.Chance(parameters.edit_probability *
                         std::exp(-distance(cell) / parameters.decay_cells));
  };
  for (const Cell cell : snapshot.visible.free) {
    if (noticed(cell)) NoteFree(cell);
  }
  const Cell axis = AxisOffset(snapshot.heading_rad);
  for (const Cell cell : snapshot.visible.walls) {
    if (!noticed(cell)) continue;
    const bool misplaced = distance(cell) <= parameters.near_cells &&
                           random.Chance(parameters.misplacement_probability);
    if (!misplaced) {
      NoteWall(cell);
    } else {
      NoteWall(random.Chance(0.5) ? cell + axis : cell - axis);
    }
  }
  const auto driven = [&](Cell cell) {
    if (cells_.Contains(cell)) cells_[cell] = {0, true};
  };
  for (const Cell cell : snapshot.path) driven(cell);
  driven(snapshot.cell);
}

void StreamMemory::NoteFree(Cell cell) {
  if (!cells_.Contains(cell)) return;
  Noticed& noticed = cells_[cell];
  noticed.free = true;
  noticed.wall = std::max(noticed.wall - 2, 0);
}

void StreamMemory::NoteWall(Cell cell) {
  if (!cells_.Contains(cell)) return;
  Noticed& noticed = cells_[cell];
  noticed.wall = std::min(noticed.wall + 1, kSure);
}

void StreamMemory::Bump(Cell wall) {
  if (cells_.Contains(wall)) cells_[wall] = {kSure, false};
}

void StreamMemory::ForgetWalls() {
  for (std::size_t i = 0; i < cells_.size(); ++i) cells_[cells_.CellAt(i)].wall = 0;
}

BeliefGrid StreamMemory::Over(const BeliefGrid& belief) const {
  BeliefGrid map = belief;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Cell cell = map.CellAt(i);
    if (IsWall(cell)) map[cell] = 1.0F;
    if (IsFree(cell)) map[cell] = 0.0F;
  }
  return map;
}

std::set<Cell> StreamMemory::Walls() const {
  std::set<Cell> walls;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (IsWall(cells_.CellAt(i))) walls.insert(cells_.CellAt(i));
  }
  return walls;
}

std::vector<CellEdit> StreamMemory::Errors(const BeliefGrid& belief, int limit) const {
  std::vector<CellEdit> edits;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const Cell cell = cells_.CellAt(i);
    if (belief.OnBorder(cell) || static_cast<int>(edits.size()) >= limit) continue;
    const bool shown_as_wall = operators::IsWall(belief, cell);
    if (IsWall(cell) && !shown_as_wall) edits.push_back({cell, true});
    if (IsFree(cell) && shown_as_wall) edits.push_back({cell, false});
  }
  return edits;
}

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// Shares of a cell. Before a corner the robot drives on until it is this near to the line of the
// next straight part; beyond that line it may be farther off.
constexpr double kCornerBefore = 0.22;
constexpr double kCornerBeyond = 0.33;
/// From here on a larger error of the heading is left alone.
constexpr double kNear = 0.5;
constexpr double kNearTolerance = 15.0 * kDegree;
/// Backward leads to a place behind within this.
constexpr double kBehind = 25.0 * kDegree;

double Bearing(Position from, Position to) {
  return std::atan2(to.y_m - from.y_m, to.x_m - from.x_m);
}

double Length(Position from, Position to) {
  return std::hypot(to.x_m - from.x_m, to.y_m - from.y_m);
}

DriveAction TurnBy(double error_rad) {
  return error_rad > 0.0 ? DriveAction::kTurnLeft : DriveAction::kTurnRight;
}

/// The end of the straight part that `path` begins with.
Cell EndOfRun(std::span<const Cell> path) {
  std::size_t last = 1;
  while (last + 1 < path.size() && path[last + 1] - path[last] == path[1] - path[0]) ++last;
  return path[last];
}

/// Whether the robot has to come nearer to the line of the first straight part before it turns.
bool BeforeCorner(const GridGeometry& geometry, const ShownPose& pose, std::span<const Cell> path) {
  const Position centre = geometry.CellToPosition(path[0]);
  const bool along_row = path[1].row == path[0].row;
  const double off =
      std::abs(along_row ? pose.position.y_m - centre.y_m : pose.position.x_m - centre.x_m) /
      geometry.cell_size_m;
  const double error = WrapAngle(Bearing(pose.position, centre) - pose.heading_rad);
  return off > (std::abs(error) < 60.0 * kDegree ? kCornerBefore : kCornerBeyond);
}

}  // namespace

void SteeringParameters::Visit(ConfigReader& reader) {
  reader.Field("reaction_steps", reaction_steps, 0, 20);
  reader.Field("forward_m", forward_m, 0.01, 1.0);
  reader.Field("backward_m", backward_m, 0.01, 1.0);
  reader.Field("turn_deg", turn_deg, 1.0, 45.0);
  reader.Field("slip_probability", slip_probability, 0.0, 1.0);
  reader.Field("overshoot_probability", overshoot_probability, 0.0, 0.9);
  reader.Field("edit_probability", edit_probability, 0.0, 1.0);
  reader.Field("order_valid_s", order_valid_s, 0.25, 5.0);
}

ShownPose Expect(const SteeringParameters& parameters, ShownPose pose, DriveAction action) {
  const auto go = [&](double distance_m) {
    pose.position.x_m += distance_m * std::cos(pose.heading_rad);
    pose.position.y_m += distance_m * std::sin(pose.heading_rad);
  };
  if (action == DriveAction::kForward) go(parameters.forward_m);
  if (action == DriveAction::kBackward) go(-parameters.backward_m);
  const double turn = parameters.turn_deg * kDegree;
  if (action == DriveAction::kTurnLeft) pose.heading_rad = WrapAngle(pose.heading_rad + turn);
  if (action == DriveAction::kTurnRight) pose.heading_rad = WrapAngle(pose.heading_rad - turn);
  return pose;
}

DriveAction ChooseKey(const SteeringParameters& parameters, const GridGeometry& geometry,
                      const ShownPose& pose, std::span<const Cell> path, bool to_centre) {
  DEMAND(!path.empty());
  if (path.size() == 1 && !to_centre) return DriveAction::kStop;
  const bool own_cell = to_centre || BeforeCorner(geometry, pose, path);
  const Position aim = geometry.CellToPosition(own_cell ? path[0] : EndOfRun(path));
  const double error = WrapAngle(Bearing(pose.position, aim) - pose.heading_rad);
  if (to_centre && std::abs(WrapAngle(error + std::numbers::pi)) < kBehind) {
    return DriveAction::kBackward;
  }
  const bool near = Length(pose.position, aim) < kNear * geometry.cell_size_m;
  const double half_turn = (parameters.turn_deg / 2.0 + 0.5) * kDegree;
  const double tolerance = near ? std::max(kNearTolerance, half_turn) : half_turn;
  return std::abs(error) > tolerance ? TurnBy(error) : DriveAction::kForward;
}

double OffCentre(const GridGeometry& geometry, Position position, Cell cell) {
  const Position centre = geometry.CellToPosition(cell);
  return std::max(std::abs(position.x_m - centre.x_m), std::abs(position.y_m - centre.y_m)) /
         geometry.cell_size_m;
}

}  // namespace conav::operators
