#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/grid/geometry.h"
#include "sim/physics/motion.h"
#include "sim/physics/world_model.h"

struct mjData_;

namespace conav::sim {

struct DataDeleter {
  void operator()(mjData_* data) const;
};

/// Rolling-ball robots in a MuJoCo maze, driven by motion primitives.
///
/// Robots and goals are addressed by their index in PhysicsWorld. Walls stop robots physically;
/// nothing here keeps two robots out of one cell or refuses a move into a wall (it ends kStuck):
/// that is the caller's decision. Robots at the centres of neighbouring cells do not touch.
/// Deterministic: the same calls give the same poses, bit for bit, on the same machine.
/// Threads: none of its own; one caller at a time. A Camera reads it between steps.
class RobotWorld {
 public:
  /// Fails with the text of CheckWorld. Robots stand still at their start cells afterwards.
  static Result<std::unique_ptr<RobotWorld>> Create(PhysicsWorld world);
  ~RobotWorld();
  RobotWorld(const RobotWorld&) = delete;
  RobotWorld& operator=(const RobotWorld&) = delete;

  /// One low-level control step of all robots: decide controls, then 50 physics steps of 0.005 s.
  void Step();

  /// Motion primitives; each replaces the one before and holds until its status is not kRunning.
  /// Turn towards the centre of `target`, drive there, settle; under 20 steps for a neighbour.
  void MoveTo(int robot, Cell target);
  /// Turn on the spot.
  void TurnTo(int robot, double heading_rad);
  /// Brake; kArrived when the robot stands (1-3 steps from top speed).
  void Halt(int robot);
  /// Raw controls in [-1, 1] until the next primitive; roll -1 = full speed forward, steer +1 =
  /// turn right (MemoryMaze's convention). Stays kRunning.
  void Drive(int robot, double roll, double steer);
  /// `speeds` for one control step, then as Halt(): a robot that is driven on is let go by nobody.
  void DriveStep(int robot, const DriveSpeeds& speeds);
  MotionStatus motion_status(int robot) const;

  RobotPose pose(int robot) const;
  /// The cell that holds the robot's axis.
  Cell cell(int robot) const;
  /// Puts a robot somewhere at rest and ends its primitive (kIdle). For set-up and tests.
  void Teleport(int robot, Position position, double heading_rad);

  /// All goals are visible at first. `goal` is the index in PhysicsWorld::goals.
  void SetGoalVisible(int goal, bool visible);
  bool goal_visible(int goal) const;

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
  /// Teleport without bringing MuJoCo's derived values up to date.
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
