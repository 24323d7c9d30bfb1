#pragma once

#include <set>
#include <span>
#include <vector>

#include "common/grid/geometry.h"
#include "common/grid/grid.h"
#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/random.h"
#include "operator/simulated/snapshot_reader.h"

namespace conav {
class ConfigReader;
}

namespace conav::operators {

/// What a synthetic teleoperator has made out in the pictures of a stream, in addition to the map:
/// cells noticed free, and walls, in which a wall must be noticed twice to be believed. A picture
/// may not be looked at, a cell overlooked (the farther the more), a near wall taken for one a cell
/// off, as the reader's parameters say; the next pictures put that right. What was driven through
/// is free.
class StreamMemory {
 public:
  StreamMemory(int rows, int columns) : cells_(rows, columns) {}

  /// `picture` shows cells inside of the map only; others are ignored.
  void Look(const SnapshotReaderParameters& parameters, const Snapshot& snapshot, Random& random);
  /// The robot bumped into it.
  void Bump(Cell wall);
  void ForgetWalls();

  bool IsWall(Cell cell) const { return cells_[cell].wall >= kBelieved; }
  bool IsFree(Cell cell) const { return cells_[cell].free && !IsWall(cell); }

  /// `belief` with what was seen instead, as 0 and 1.
  BeliefGrid Over(const BeliefGrid& belief) const;
  std::set<Cell> Walls() const;
  /// Cells inside of the border that `belief` shows otherwise than they were seen, row-major, at
  /// most `limit`.
  std::vector<CellEdit> Errors(const BeliefGrid& belief, int limit) const;

 private:
  static constexpr int kBelieved = 2;  // times
  static constexpr int kSure = 4;
  struct Noticed {
    int wall = 0;  // how often, of late
    bool free = false;
  };
  void NoteFree(Cell cell);
  void NoteWall(Cell cell);

  Grid<Noticed> cells_;
};

}  // namespace conav::operators

/// How the synthetic teleoperator chooses keys: aims along a path of cells at a fixed speed, with
/// an idea of what a key does. Pure functions.
namespace conav::operators {

/// Where a robot is, as the operator's map shows it.
struct ShownPose {
  Position position;
  double heading_rad = 0.0;
};

struct SteeringParameters {
  /// The operator acts on the pose and the picture of so many control steps (0.25 s) ago, and on
  /// what the keys pressed since then should have done.
  int reaction_steps = 1;
  /// What one key press does, as the operator expects it.
  double forward_m = 0.2;
  double backward_m = 0.1;
  double turn_deg = 11.25;
  /// Another key than meant is pressed.
  double slip_probability = 0.02;
  /// A key is held for one more step when it should change.
  double overshoot_probability = 0.05;
  /// Chance per step that errors of the map noticed so far are corrected on it.
  double edit_probability = 0.1;
  /// Orders expire after this long, simulation time.
  double order_valid_s = 2.0;

  void Visit(ConfigReader& reader);
};

/// The pose after `action`, as the operator expects it.
ShownPose Expect(const SteeringParameters& parameters, ShownPose pose, DriveAction action);

/// The key that leads along `path` (4-connected, from the robot's cell on): straight to the end of
/// the first straight part, corners are cut only where there is room. kStop at the end of the
/// path. `to_centre`: back to the middle of the robot's own cell first, backward if that is nearer.
DriveAction ChooseKey(const SteeringParameters& parameters, const GridGeometry& geometry,
                      const ShownPose& pose, std::span<const Cell> path, bool to_centre);

/// From the middle of `cell`, in cells, on the axis where it is more.
double OffCentre(const GridGeometry& geometry, Position position, Cell cell);

}  // namespace conav::operators
