#include "bench/console/world.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "common/grid/visibility.h"

namespace conav::bench {
namespace {

constexpr int kRoom = 10;       // cells from wall to wall
constexpr int kSightCells = 2;  // as far as a robot sees around itself
constexpr int kOneWrongIn = 9;  // cells of the operator's map

/// Rows from north to south, as evenly as they go.
int RowOf(const Drive& drive, int robot) { return 1 + robot * (drive.side - 2) / drive.robots; }

bool IsRoomWall(Cell cell) {
  const auto is_door = [](int at) { return at % kRoom == kRoom / 2; };
  return (cell.row % kRoom == 0 && !is_door(cell.column)) ||
         (cell.column % kRoom == 0 && !is_door(cell.row));
}

}  // namespace

double Drive::PeriodS() const { return (side - 2) * kCellSizeM / kSpeedMps; }

double Drive::WestM() const { return (1.0 - side / 2.0) * kCellSizeM; }

double Drive::AgeS(double x_m, double now_s) const {
  return std::remainder(now_s - begin_s - (x_m - WestM()) / kSpeedMps, PeriodS());
}

std::string RobotName(int robot) { return fmt::format("r{}", robot + 1); }

OccupancyGrid TrueMap(const Drive& drive) {
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

OccupancyGrid InitialMap(const OccupancyGrid& truth) {
  OccupancyGrid map = truth;
  for (std::size_t i = 0; i < map.size(); i += kOneWrongIn) {
    const Cell cell = map.CellAt(i);
    if (map.OnBorder(cell)) continue;
    map[cell] = map[cell] == Occupancy::kFree ? Occupancy::kOccupied : Occupancy::kFree;
  }
  return map;
}

DrivingRobot::DrivingRobot(const Drive& drive, const OccupancyGrid& truth, int robot)
    : drive_(drive),
      truth_(truth),
      view_(ViewThrough(CameraLens(), {}, 0.0, Drive::kCellSizeM)),
      seen_(truth.rows(), truth.columns(), Occupancy::kUnknown) {
  state_.world = "w1";
  state_.robot = RobotName(robot);
  state_.cell = {RowOf(drive, robot), 0};
  state_.position =
      GridGeometry{drive.side, drive.side, Drive::kCellSizeM}.CellToPosition(state_.cell);
  state_.goals_left = {{1, 1}, {drive.side - 2, 1}, {1, drive.side - 2}};
  state_.goals_total = 3;
  state_.command_outcome = CommandOutcome::kRunning;
}

RobotState DrivingRobot::State(double now_s) {
  const double driven_s = now_s - drive_.begin_s;
  state_.stamp = SimTime::FromSeconds(driven_s);
  state_.position.x_m = drive_.WestM() + std::fmod(driven_s, drive_.PeriodS()) * Drive::kSpeedMps;
  const Cell cell{state_.cell.row,
                  1 + static_cast<int>((state_.position.x_m - drive_.WestM()) / Drive::kCellSizeM)};
  if (cell != state_.cell) {
    ++state_.cell_moves;
    state_.cell = cell;
    state_.command_cell = cell + Cell{0, 1};
    state_.path.push_back(cell);
    See(cell);
  }
  return state_;
}

void DrivingRobot::See(Cell cell) {
  for (int row = -kSightCells; row <= kSightCells; ++row) {
    for (int column = -kSightCells; column <= kSightCells; ++column) {
      const Cell near = cell + Cell{row, column};
      if (!seen_.Contains(near) || seen_[near] == truth_[near]) continue;
      seen_[near] = truth_[near];
      map_is_new_ = true;
    }
  }
}

Snapshot DrivingRobot::TakeSnapshot(const std::vector<std::uint8_t>& jpeg) {
  const CameraLens lens;
  Snapshot picture;
  picture.stamp = state_.stamp;
  picture.world = state_.world;
  picture.robot = state_.robot;
  picture.sequence_number = ++state_.snapshots;
  picture.cell = state_.cell;
  picture.horizontal_fov_rad = lens.horizontal_fov_rad;
  picture.width = static_cast<std::uint32_t>(lens.width);
  picture.height = static_cast<std::uint32_t>(lens.height);
  picture.jpeg = jpeg;
  picture.visible = view_.Cast(truth_, state_.cell);
  picture.path = std::exchange(state_.path, {state_.cell});
  picture.goals_left = state_.goals_left;
  ++state_.pictures;
  state_.picture_bytes += jpeg.size();
  return picture;
}

MapUpdate DrivingRobot::Map() {
  map_is_new_ = false;
  state_.map_stamp = state_.stamp;
  return {state_.stamp, Drive::kCellSizeM, seen_};
}

}  // namespace conav::bench
