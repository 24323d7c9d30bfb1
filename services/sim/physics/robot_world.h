#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "common/grid/geometry.h"
#include "sim/physics/world_model.h"

namespace conav::sim {

enum class MotionStatus : std::uint8_t {
  kIdle,     // nothing commanded yet
  kRunning,  // the primitive is under way
  kArrived,  // done: in place and (nearly) at rest
  kStuck,    // not done after kStuckSteps: something blocks the robot; it brakes
};

/// Map frame, metres and radians.
struct RobotPose {
  Position position;
  double heading_rad = 0.0;   // (-pi, pi]
  double speed_mps = 0.0;     // along the heading, forward positive
  double yaw_rate_rps = 0.0;  // counter-clockwise positive
};

/// Continuous controls in [-1, 1], held for one 4 Hz step.
struct Controls {
  double forward = 0.0;
  double turn_left = 0.0;
};

struct ControlDecision {
  Controls controls;
  bool arrived = false;
  bool driving = false;  // DecideMove: turned far enough to drive; pass it to the next step
};

/// A primitive gives up after this many control steps, a longer way after as many as it takes at a
/// quarter of the full speed.
inline constexpr int kStuckSteps = 60;

/// Closed-loop motion primitives, one decision per 4 Hz step. Rolling and turning behave like
/// first-order systems, v' = (u v_max - friction - v) / tau, so a robot that coasts after one step
/// of T seconds under u comes to rest about tau v + u v_max T ahead. Solved for u and clamped to
/// [-1, 1], that is the control that ends at the target. Pure functions; the constants are fitted
/// to the measured motion of the model (tests/unit/sim/physics/robot_world_test.cc). `top_mps` is the
/// world's top_speed_mps.

/// So near to its place a robot settles.
inline constexpr double kSettledM = 0.06;

/// Turn towards `target`, drive, settle. Arrived within kSettledM and nearly at rest; with a larger
/// `tolerance_m` as soon as the axis is that near.
ControlDecision DecideMove(const RobotPose& pose, Position target, bool driving,
                           double tolerance_m = kSettledM, double top_mps = kTopSpeedMps);
/// Arrived within 1 degree and nearly at rest.
ControlDecision DecideTurn(const RobotPose& pose, double heading_rad,
                           double top_mps = kTopSpeedMps);
/// Brakes both motions.
ControlDecision DecideHalt(const RobotPose& pose, double top_mps = kTopSpeedMps);

/// Speeds of a low-level action; backward and clockwise are negative.
struct DriveSpeeds {
  double forward_mps = 0.0;
  double turn_rps = 0.0;
};
/// The control that ends this step at `speeds`, or as close as the motors allow.
ControlDecision DecideDrive(const RobotPose& pose, const DriveSpeeds& speeds,
                            double top_mps = kTopSpeedMps);
/// How far ahead (negative: back) a step of DecideDrive and the braking after it take the robot.
double DriveReach(const RobotPose& pose, const DriveSpeeds& speeds, double top_mps = kTopSpeedMps);

}  // namespace conav::sim

struct mjData_;

namespace conav::sim {

struct DataDeleter {
  void operator()(mjData_* data) const;
};

/// Rolling-ball robots in a MuJoCo maze, driven by motion primitives.
///
/// The index in PhysicsWorld addresses a robot or goal. Walls stop robots physically; but keeping
/// two robots out of one cell, or a robot from moving into a wall (it ends kStuck), is up to the
/// caller. Robots at the centres of neighbouring cells do not touch. Deterministic: the same calls
/// give the same poses, bit for bit, on the same machine. Threads: none of its own; one caller at a
/// time. A Camera reads it between steps.
class RobotWorld {
 public:
  /// Fails with the text of CheckWorld. Afterwards robots stand still at their start cells.
  static Result<std::unique_ptr<RobotWorld>> Create(PhysicsWorld world);
  ~RobotWorld();
  RobotWorld(const RobotWorld&) = delete;
  RobotWorld& operator=(const RobotWorld&) = delete;

  /// One low-level control step of all robots: decide controls, then 50 physics steps of 0.005 s.
  /// `between` is called after each physics step but the last, with its number from 1; it may read
  /// poses.
  void Step(const std::function<void(int substep)>& between = nullptr);

  /// Motion primitives; each replaces the previous one and holds until its status is not kRunning.
  /// Turn towards `target`, drive there, settle, or go through within a tolerance above kSettledM.
  void DriveTo(int robot, Position target, double tolerance_m = kSettledM);
  /// The same to the middle of a cell; under 20 steps for a neighbour of 2 m.
  void MoveTo(int robot, Cell target) { DriveTo(robot, geometry_.CellToPosition(target)); }
  /// Turn on the spot.
  void TurnTo(int robot, double heading_rad);
  /// Brake; kArrived when the robot stands (1-3 steps from top speed).
  void Halt(int robot);
  /// Raw controls in [-1, 1] until the next primitive; roll -1 = full speed forward, steer +1 =
  /// turn right (MemoryMaze's convention). Stays kRunning.
  void Drive(int robot, double roll, double steer);
  /// `speeds` for one control step, then as Halt(). The next DriveStep continues without braking.
  void DriveStep(int robot, const DriveSpeeds& speeds);
  MotionStatus motion_status(int robot) const;

  RobotPose pose(int robot) const;
  /// The cell that holds the robot's axis.
  Cell cell(int robot) const;
  /// Places a robot at rest and ends its primitive (kIdle). For set-up and tests.
  void Teleport(int robot, Position position, double heading_rad);

  /// Goes on counting from here. For a world that begins where another one ended.
  void SetSteps(std::uint64_t steps) { steps_ = steps; }

  /// All goals are visible at first. `goal` is the index in PhysicsWorld::goals.
  void SetGoalVisible(int goal, bool visible);
  bool goal_visible(int goal) const;

  /// Makes the cell of PhysicsWorld::doors[door] a wall, also of world().truth; no robot may be in it.
  void CloseDoor(int door);

  double time_s() const;
  std::uint64_t steps() const { return steps_; }
  int robot_count() const { return static_cast<int>(world_.robots.size()); }
  const PhysicsWorld& world() const { return world_; }
  const GridGeometry& geometry() const { return geometry_; }

  /// For the camera: read only, valid as long as this object.
  const mjModel_& model() const { return *model_; }
  mjData_& data() const { return *data_; }

 private:
  struct Robot;
  RobotWorld(PhysicsWorld world, ModelPtr model);
  Robot& RobotAt(int robot);
  const Robot& RobotAt(int robot) const;
  /// Teleport without updating MuJoCo's derived values.
  void Place(int robot, Position position, double heading_rad);

  PhysicsWorld world_;
  GridGeometry geometry_;
  ModelPtr model_;
  std::unique_ptr<mjData_, DataDeleter> data_;
  std::vector<Robot> robots_;
  std::vector<int> goal_geoms_;
  std::uint64_t steps_ = 0;
};

}  // namespace conav::sim
