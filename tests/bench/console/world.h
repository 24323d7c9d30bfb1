#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/grid/visibility.h"
#include "common/msg/robot.h"

namespace conav::bench {

/// What is played to the console: robots that drive eastwards through a square world, each in a row
/// of its own, and begin again in the west. A robot's place tells the time.
struct Drive {
  int robots = 16;       // 1..26: each has a letter of its own on the map
  int side = 150;        // cells; at least robots + 2
  double begin_s = 0.0;  // wall time at which they set out

  static constexpr double kCellSizeM = 2.0;
  static constexpr double kSpeedMps = 0.8;  // as a person drives them

  /// s until they begin again.
  double PeriodS() const;
  /// x of a robot that begins.
  double WestM() const;
  /// s between `now_s` and the time at which a robot was at `x_m`.
  double AgeS(double x_m, double now_s) const;
};

std::string RobotName(int robot);  // "r1" for 0

/// Rooms with doors, and the robots' rows free.
OccupancyGrid TrueMap(const Drive& drive);
/// What the operator takes it for at first: some walls are missing, some are not there.
OccupancyGrid InitialMap(const OccupancyGrid& truth);

/// One robot on its way: what it says at a time.
class DrivingRobot {
 public:
  DrivingRobot(const Drive& drive, const OccupancyGrid& truth, int robot);

  /// `now_s`: wall time, not before the drive's begin. What it has seen grows with it.
  RobotState State(double now_s);
  /// Of a camera, after State(); the next one in its order.
  Snapshot TakeSnapshot(const std::vector<std::uint8_t>& jpeg);
  /// What it has seen, if that is more than at the call before.
  bool HasNewMap() const { return map_is_new_; }
  MapUpdate Map();

 private:
  void See(Cell cell);

  const Drive& drive_;
  const OccupancyGrid& truth_;
  ViewCaster view_;
  OccupancyGrid seen_;
  RobotState state_;
  bool map_is_new_ = false;
};

}  // namespace conav::bench
