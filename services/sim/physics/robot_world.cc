#include "sim/physics/robot_world.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/runtime/result.h"
#include "sim/physics/mjcf.h"

namespace conav::sim {
namespace {

constexpr double kDegree = 0.017453292519943295;

/// v' = (u max_rate - friction sign(v) - v) / lag_s, rates in m/s or rad/s.
struct Axis {
  double max_rate;  // at full control, without friction
  double lag_s;
  double friction;
  double good_enough;  // release the control when coasting ends this close
};
constexpr Axis Roll(double top_mps) { return {top_mps, 0.168, 0.0, 0.0}; }
/// Motor 30 N m, damping 20 N m s, inertia 1.17 kg m^2, torsional friction 0.02 m * 216 N.
constexpr Axis kSteer{30.0 / 20.0, 1.17 / 20.0, 4.32 / 20.0, 0.4 * kDegree};

constexpr double kNearM = 0.3;  // closer than this the heading is held: the bearing becomes noise
constexpr double kArrivedAngleRad = 1.0 * kDegree;
constexpr double kDriveAngleRad = 2.0 * kDegree;
constexpr double kLostAngleRad = 25.0 * kDegree;
constexpr double kRestMps = 0.04;
constexpr double kRestRps = 6.0 * kDegree;

/// How far the motion continues after the control is released.
double CoastingDistance(const Axis& axis, double rate) {
  const double speed = std::abs(rate);
  const double lost = axis.friction > 0.0 ? axis.friction * std::log1p(speed / axis.friction) : 0.0;
  return std::copysign(axis.lag_s * (speed - lost), rate);
}

/// The control after which the robot, coasting after this step, stops `distance` ahead.
double Approach(const Axis& axis, double distance, double rate) {
  if (std::abs(distance - CoastingDistance(axis, rate)) < axis.good_enough) return 0.0;
  const double needed = distance - axis.lag_s * rate;
  const double sign = needed < 0.0 ? -1.0 : 1.0;
  double net_rate = std::abs(needed) / kControlStepS;
  if (axis.friction > 0.0) {
    // Friction shortens the coasting by lag f ln(1 + r / f); three fixed-point rounds converge.
    for (int round = 0; round < 3; ++round) {
      const double lost = axis.lag_s * axis.friction * std::log1p(net_rate / axis.friction);
      net_rate = (std::abs(needed) + lost) / kControlStepS;
    }
  }
  return std::clamp(sign * (net_rate + axis.friction) / axis.max_rate, -1.0, 1.0);
}

/// The share of a rate that remains after a step without control.
double Kept(const Axis& axis) { return std::exp(-kControlStepS / axis.lag_s); }

/// The control that ends this step at `target`; friction opposes motion in that direction.
double Reach(const Axis& axis, double rate, double target) {
  const double steady = (target - rate * Kept(axis)) / (1.0 - Kept(axis));
  const double friction = target == 0.0 ? 0.0 : std::copysign(axis.friction, target);
  return std::clamp((steady + friction) / axis.max_rate, -1.0, 1.0);
}

/// The control that ends this step at rest; friction alone stops the turning.
double Brake(const Axis& axis, double rate) {
  return axis.friction > 0.0 ? 0.0 : Reach(axis, rate, 0.0);
}

/// For an axis without friction: the distance it travels in a step that ends as close to `target`
/// as possible, and its rate at the end.
struct Travel {
  double distance;
  double rate;
};
Travel TravelOf(const Axis& axis, double rate, double target) {
  const double steady = axis.max_rate * Reach(axis, rate, target);
  const double lost = 1.0 - Kept(axis);
  return {steady * kControlStepS + (rate - steady) * axis.lag_s * lost,
          steady * lost + rate * Kept(axis)};
}

bool AtRest(const RobotPose& pose) {
  return std::abs(pose.speed_mps) < kRestMps && std::abs(pose.yaw_rate_rps) < kRestRps;
}

enum class Primitive : std::uint8_t { kNone, kMove, kTurn, kHalt, kDrive, kDriveStep };

int FindId(const mjModel& model, mjtObj type, const std::string& name) {
  const int id = mj_name2id(&model, type, name.c_str());
  DEMAND(id >= 0, name);
  return id;
}

}  // namespace

ControlDecision DecideMove(const RobotPose& pose, Position target, bool driving, double tolerance_m,
                           double top_mps) {
  const double dx = target.x_m - pose.position.x_m;
  const double dy = target.y_m - pose.position.y_m;
  const double distance = std::hypot(dx, dy);
  ControlDecision decision;
  const bool passes = tolerance_m > kSettledM && distance < tolerance_m;
  if (passes || (distance < kSettledM && AtRest(pose))) {
    decision.arrived = true;
    return decision;
  }
  const double bearing_error = WrapAngle(std::atan2(dy, dx) - pose.heading_rad);
  const double ahead = distance * std::cos(bearing_error);
  const double aside = distance * std::sin(bearing_error);
  const bool near = distance < kNearM;
  const double limit = driving ? kLostAngleRad : kDriveAngleRad;
  decision.driving = near ? std::abs(aside) < kSettledM : std::abs(bearing_error) < limit;
  if (near && decision.driving) {
    decision.controls = {Approach(Roll(top_mps), ahead, pose.speed_mps),
                         Brake(kSteer, pose.yaw_rate_rps)};
    return decision;
  }
  const double turn = Approach(kSteer, bearing_error, pose.yaw_rate_rps);
  const double roll = decision.driving ? Approach(Roll(top_mps), ahead, pose.speed_mps)
                                       : Brake(Roll(top_mps), pose.speed_mps);
  decision.controls = {roll, turn};
  return decision;
}

ControlDecision DecideTurn(const RobotPose& pose, double heading_rad, double top_mps) {
  const double error = WrapAngle(heading_rad - pose.heading_rad);
  ControlDecision decision;
  decision.arrived = std::abs(error) < kArrivedAngleRad && AtRest(pose);
  if (decision.arrived) return decision;
  decision.controls = {Brake(Roll(top_mps), pose.speed_mps),
                       Approach(kSteer, error, pose.yaw_rate_rps)};
  return decision;
}

ControlDecision DecideHalt(const RobotPose& pose, double top_mps) {
  ControlDecision decision;
  decision.arrived = AtRest(pose);
  if (decision.arrived) return decision;
  decision.controls = {Brake(Roll(top_mps), pose.speed_mps), Brake(kSteer, pose.yaw_rate_rps)};
  return decision;
}

ControlDecision DecideDrive(const RobotPose& pose, const DriveSpeeds& speeds, double top_mps) {
  const double turn = speeds.turn_rps == 0.0 ? Brake(kSteer, pose.yaw_rate_rps)
                                             : Reach(kSteer, pose.yaw_rate_rps, speeds.turn_rps);
  return {{Reach(Roll(top_mps), pose.speed_mps, speeds.forward_mps), turn}};
}

double DriveReach(const RobotPose& pose, const DriveSpeeds& speeds, double top_mps) {
  const Travel step = TravelOf(Roll(top_mps), pose.speed_mps, speeds.forward_mps);
  return step.distance + TravelOf(Roll(top_mps), step.rate, 0.0).distance;
}

void DataDeleter::operator()(mjData_* data) const { mj_deleteData(data); }

/// Where a robot's joints and motors are in MuJoCo's arrays, and what it is doing.
struct RobotWorld::Robot {
  int x_joint = 0;  // y and z follow
  int steer_joint = 0;
  int roll_joint = 0;
  int roll_motor = 0;
  int steer_motor = 0;

  Primitive primitive = Primitive::kNone;
  MotionStatus status = MotionStatus::kIdle;
  Position target;
  double tolerance_m = kSettledM;
  double top_mps = kTopSpeedMps;
  int patience_steps = kStuckSteps;
  double heading_rad = 0.0;
  Controls drive;
  DriveSpeeds speeds;
  bool driving = false;
  int primitive_steps = 0;

  void Start(Primitive next) {
    primitive = next;
    status = next == Primitive::kNone ? MotionStatus::kIdle : MotionStatus::kRunning;
    driving = false;
    primitive_steps = 0;
    patience_steps = kStuckSteps;
  }
  ControlDecision Decide(const RobotPose& pose) const;
  /// Controls for the next step; advances `status`.
  Controls NextControls(const RobotPose& pose);
};

ControlDecision RobotWorld::Robot::Decide(const RobotPose& pose) const {
  switch (primitive) {
    case Primitive::kMove:
      return DecideMove(pose, target, driving, tolerance_m, top_mps);
    case Primitive::kTurn:
      return DecideTurn(pose, heading_rad, top_mps);
    case Primitive::kHalt:
      return DecideHalt(pose, top_mps);
    case Primitive::kDrive:
      return {drive};
    case Primitive::kDriveStep:
      return DecideDrive(pose, speeds, top_mps);
    case Primitive::kNone:
      break;
  }
  return {};
}

Controls RobotWorld::Robot::NextControls(const RobotPose& pose) {
  if (status == MotionStatus::kStuck) return DecideHalt(pose, top_mps).controls;
  if (status != MotionStatus::kRunning) return {};
  if (primitive != Primitive::kDrive && primitive_steps >= patience_steps) {
    status = MotionStatus::kStuck;
    return DecideHalt(pose, top_mps).controls;
  }
  ++primitive_steps;
  const ControlDecision decision = Decide(pose);
  driving = decision.driving;
  return decision.controls;
}

Result<std::unique_ptr<RobotWorld>> RobotWorld::Create(PhysicsWorld world) {
  auto model_result = BuildModel(world);
  if (!model_result) return tl::unexpected(model_result.error());
  return std::unique_ptr<RobotWorld>(
      new RobotWorld(std::move(world), std::move(model_result.value())));
}

RobotWorld::RobotWorld(PhysicsWorld world, ModelPtr model)
    : world_(std::move(world)),
      geometry_{world_.truth.rows(), world_.truth.columns(), world_.cell_size_m},
      model_(std::move(model)),
      data_(mj_makeData(model_.get())) {
  for (int i = 0; i < robot_count(); ++i) {
    Robot robot;
    robot.x_joint = FindId(*model_, mjOBJ_JOINT, RobotElement(i, "x"));
    robot.steer_joint = FindId(*model_, mjOBJ_JOINT, RobotElement(i, "steer"));
    robot.roll_joint = FindId(*model_, mjOBJ_JOINT, RobotElement(i, "roll"));
    robot.roll_motor = FindId(*model_, mjOBJ_ACTUATOR, RobotElement(i, "roll"));
    robot.steer_motor = FindId(*model_, mjOBJ_ACTUATOR, RobotElement(i, "steer"));
    robot.top_mps = world_.top_speed_mps;
    robots_.push_back(robot);
  }
  for (int i = 0; i < static_cast<int>(world_.goals.size()); ++i) {
    goal_geoms_.push_back(FindId(*model_, mjOBJ_GEOM, GoalElement(i)));
  }
  for (int i = 0; i < robot_count(); ++i) {
    const RobotSpec& spec = world_.robots[static_cast<std::size_t>(i)];
    Place(i, geometry_.CellToPosition(spec.start), spec.heading_rad);
  }
  mj_forward(model_.get(), data_.get());
}

RobotWorld::~RobotWorld() = default;

RobotWorld::Robot& RobotWorld::RobotAt(int robot) {
  DEMAND(robot >= 0 && robot < robot_count(), robot, robot_count());
  return robots_[static_cast<std::size_t>(robot)];
}

const RobotWorld::Robot& RobotWorld::RobotAt(int robot) const {
  return const_cast<RobotWorld*>(this)->RobotAt(robot);
}

void RobotWorld::Step(const std::function<void(int)>& between) {
  for (int i = 0; i < robot_count(); ++i) {
    Robot& robot = RobotAt(i);
    const Controls controls = robot.NextControls(pose(i));
    data_->ctrl[robot.roll_motor] = -controls.forward;
    data_->ctrl[robot.steer_motor] = -controls.turn_left;
  }
  for (int substep = 1; substep <= kSubsteps; ++substep) {
    mj_step(model_.get(), data_.get());
    if (between && substep < kSubsteps) between(substep);
  }
  ++steps_;
  for (int i = 0; i < robot_count(); ++i) {
    Robot& robot = RobotAt(i);
    if (robot.primitive == Primitive::kDriveStep) robot.Start(Primitive::kHalt);
    if (robot.status == MotionStatus::kRunning && robot.Decide(pose(i)).arrived) {
      robot.status = MotionStatus::kArrived;
    }
  }
}

void RobotWorld::DriveTo(int robot, Position target, double tolerance_m) {
  DEMAND(std::isfinite(target.x_m) && std::isfinite(target.y_m), target.x_m, target.y_m);
  const Position from = pose(robot).position;
  const double way_m = std::hypot(target.x_m - from.x_m, target.y_m - from.y_m);
  Robot& moving = RobotAt(robot);
  moving.Start(Primitive::kMove);
  moving.target = target;
  moving.tolerance_m = tolerance_m;
  const double slow_mps = world_.top_speed_mps / 4.0;
  moving.patience_steps =
      std::max(kStuckSteps, static_cast<int>(std::ceil(way_m / (slow_mps * kControlStepS))));
}

void RobotWorld::TurnTo(int robot, double heading_rad) {
  DEMAND(std::isfinite(heading_rad), heading_rad);
  RobotAt(robot).Start(Primitive::kTurn);
  RobotAt(robot).heading_rad = heading_rad;
}

void RobotWorld::Halt(int robot) { RobotAt(robot).Start(Primitive::kHalt); }

void RobotWorld::Drive(int robot, double roll, double steer) {
  DEMAND(std::abs(roll) <= 1.0 && std::abs(steer) <= 1.0, roll, steer);
  RobotAt(robot).Start(Primitive::kDrive);
  RobotAt(robot).drive = {-roll, -steer};
}

void RobotWorld::DriveStep(int robot, const DriveSpeeds& speeds) {
  RobotAt(robot).Start(Primitive::kDriveStep);
  RobotAt(robot).speeds = speeds;
}

MotionStatus RobotWorld::motion_status(int robot) const { return RobotAt(robot).status; }

RobotPose RobotWorld::pose(int robot) const {
  const Robot& joints = RobotAt(robot);
  const mjtNum* position = data_->qpos + model_->jnt_qposadr[joints.x_joint];
  const mjtNum* velocity = data_->qvel + model_->jnt_dofadr[joints.x_joint];
  // MuJoCo's steer joint turns clockwise.
  const double heading = WrapAngle(-data_->qpos[model_->jnt_qposadr[joints.steer_joint]]);
  return {{position[0], position[1]},
          heading,
          velocity[0] * std::cos(heading) + velocity[1] * std::sin(heading),
          -data_->qvel[model_->jnt_dofadr[joints.steer_joint]]};
}

Cell RobotWorld::cell(int robot) const { return geometry_.PositionToCell(pose(robot).position); }

void RobotWorld::Teleport(int robot, Position position, double heading_rad) {
  Place(robot, position, heading_rad);
  mj_forward(model_.get(), data_.get());
}

void RobotWorld::Place(int robot, Position position, double heading_rad) {
  const Robot& joints = RobotAt(robot);
  const int x = model_->jnt_qposadr[joints.x_joint];
  data_->qpos[x] = position.x_m;
  data_->qpos[x + 1] = position.y_m;
  data_->qpos[x + 2] = 0.0;
  data_->qpos[model_->jnt_qposadr[joints.steer_joint]] = -heading_rad;
  const int dof = model_->jnt_dofadr[joints.x_joint];
  std::fill_n(data_->qvel + dof, 3, 0.0);
  for (const int joint : {joints.steer_joint, joints.roll_joint}) {
    data_->qvel[model_->jnt_dofadr[joint]] = 0.0;
  }
  RobotAt(robot).Start(Primitive::kNone);
}

void RobotWorld::SetGoalVisible(int goal, bool visible) {
  DEMAND(goal >= 0 && static_cast<std::size_t>(goal) < goal_geoms_.size(), goal);
  model_->geom_group[goal_geoms_[static_cast<std::size_t>(goal)]] =
      visible ? kVisibleGroup : kHiddenGroup;
}

bool RobotWorld::goal_visible(int goal) const {
  DEMAND(goal >= 0 && static_cast<std::size_t>(goal) < goal_geoms_.size(), goal);
  return model_->geom_group[goal_geoms_[static_cast<std::size_t>(goal)]] == kVisibleGroup;
}

void RobotWorld::CloseDoor(int door) {
  DEMAND(door >= 0 && static_cast<std::size_t>(door) < world_.doors.size(), door);
  const Cell cell = world_.doors[static_cast<std::size_t>(door)];
  for (int robot = 0; robot < robot_count(); ++robot)
    DEMAND(this->cell(robot) != cell, robot, door);
  for (int part = 0; part < kDoorParts; ++part) {
    const int geom = FindId(*model_, mjOBJ_GEOM, DoorElement(door, part));
    if (part > 0) model_->geom_group[geom] = kVisibleGroup;
    model_->geom_pos[3 * geom + 2] = kWallHeightM / 2.0;
  }
  world_.truth[cell] = Occupancy::kOccupied;
  mj_forward(model_.get(), data_.get());
}

double RobotWorld::time_s() const { return static_cast<double>(steps_) * kControlStepS; }

}  // namespace conav::sim
