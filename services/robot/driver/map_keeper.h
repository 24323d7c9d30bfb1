#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "common/grid/geometry.h"
#include "common/grid/grid.h"
#include "common/runtime/clock.h"
#include "robot/driver/alignment.h"

namespace conav::robot {

/// A robot's own map as ROS 2 carries it: of any resolution, anywhere, also turned. Row 0 of `data` is
/// the one at the origin; -1 is unknown, else 0 to 100.
struct RobotMap {
  double resolution_m = 0.05;
  Pose plan_from_origin;  // of the corner of its first cell
  int columns = 0;
  int rows = 0;
  std::vector<std::int8_t> data;
};

/// What the robot knows, on the cells of the operator's plan.
///
/// 1. A cell is a wall if the robot, a disc of `radius_m`, cannot stand in its middle, or if what is
///    known of it is a wall for a third or more;
/// 2. else it is free if half of it or more is;
/// 3. where a wall runs between the middles of two cells that are not walls, the one of which less is
///    free becomes one: planners drive from middle to middle, and a wall on the line between two cells
///    must not vanish.
/// A cell once known stays as it was when the robot's map no longer covers it.
class MapKeeper {
 public:
  struct Options {
    double radius_m = 0.25;
    int free_up_to = 25;  // values of the robot's map
    int occupied_from = 65;
  };
  MapKeeper(const GridGeometry& grid, const Options& options);

  /// Cost: the cells of `map`, and those of the grid that it covers times their samples.
  void Receive(RobotMap map);
  /// A way that did not work though the map shows nothing: a wall until then.
  void Block(Cell cell, Clock::TimePoint until) { blocked_[cell] = until; }
  /// Where the robot stands is free.
  void Stand(Cell cell) { stands_in_ = cell; }

  /// What to publish.
  OccupancyGrid Known(Clock::TimePoint now) const;
  /// The first cell that stops the straight way, in which a wall is known, or the last one if a wall
  /// of the robot's own map crosses the way; the robot's own cell never does.
  std::optional<Cell> FirstObstacle(Position from, Position to, Clock::TimePoint now) const;

  const GridGeometry& grid() const { return grid_; }

 private:
  enum class Fine : std::uint8_t { kUnknown, kFree, kWall };
  struct Share {  // of the samples of a cell
    int free = 0;
    int walls = 0;
    int all = 0;
  };

  Fine FineAt(Position place) const;
  bool IsThickAt(Position place) const;
  Position ToMap(Position place) const;
  std::optional<std::size_t> IndexOf(Position place) const;
  void Thicken();
  Share ShareOf(Cell cell) const;
  bool IsCrossed(Position from, Position to) const;
  void PartNeighbours(OccupancyGrid& seen, const Grid<Share>& shares) const;

  GridGeometry grid_;
  Options options_;
  OccupancyGrid known_;
  std::map<Cell, Clock::TimePoint> blocked_;
  std::optional<Cell> stands_in_;
  RobotMap map_;
  Pose origin_from_plan_;
  double cosine_ = 1.0;  // of its turn
  double sine_ = 0.0;
  std::vector<std::uint8_t> thick_;  // cells of map_ whose distance to a wall is below the radius
};

}  // namespace conav::robot
