#pragma once

#include <span>

#include "common/grid/geometry.h"
#include "common/protocol/robot.h"
#include "common/runtime/config.h"

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
/// the first straight part, corners are cut no more than there is room for. kStop at the end of the
/// path. `to_centre`: back to the middle of the robot's own cell first, backward if that is nearer.
DriveAction ChooseKey(const SteeringParameters& parameters, const GridGeometry& geometry,
                      const ShownPose& pose, std::span<const Cell> path, bool to_centre);

/// From the middle of `cell`, in cells, on the axis where it is more.
double OffCentre(const GridGeometry& geometry, Position position, Cell cell);

}  // namespace conav::operators
