#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/grid/geometry.h"
#include "common/msg/robot.h"
#include "common/runtime/result.h"
#include "robot/command_gate.h"
#include "sim/physics/robot_world.h"
#include "sim/world/world_spec.h"

namespace conav::sim {

/// A world for the physics, with a robot of each name; the robots' bodies and the texture seed keep their defaults.
PhysicsWorld PhysicsOf(const WorldSpec& spec, const std::vector<std::string>& robots);

/// The simulator's state of one robot besides its physics.
struct RobotRecord {
  RobotState state;  // as published, except for the stamp and what `gate` reports
  MapUpdate map;     // what this robot has seen
  robot::CommandGate gate{""};
  bool braking = false;   // ended early, still rolling
  bool coasting = false;  // a drive action ended, still rolling: brakes when time advances
  Position position;      // of the axis at the last cell tracking
  CommandOutcome drive_outcome = CommandOutcome::kNone;  // of the drive action in force
  std::string drive_detail;
  std::deque<Cell> waypoints;   // remaining cell centres, the command's destination last
  std::deque<Position> places;  // the same in open terrain
  std::vector<Cell> reserved;   // closed to other robots
  bool turned = false;          // the view's heading is reached
  std::uint64_t version = 1;    // of what is published
};

/// Speeds of low-level actions, both at least 0.
struct DriveLimits {
  double forward_mps = 0.8;
  double backward_mps = 0.4;
  double turn_rps = 0.7853981633974483;  // 45 degrees per second
};

struct EpisodeOptions {
  std::string world = "w1";
  std::vector<std::vector<Cell>> goals;  // per robot, as in WorldSpec
  bool shared_goals = false;
  double observation_distance_cells = 2.0;
  DriveLimits drive;
  /// Robots drive anywhere in open terrain, not from cell to neighbouring cell.
  bool open = false;
  double robot_radius_m = 0.2;  // in open terrain
  /// Otherwise, as in the field, the operator service keeps its goals; it reaches none here.
  bool keeps_goals = true;
  /// Those of PhysicsWorld::doors. One waits while a robot is in its cell or on the way there.
  std::vector<Door> doors{};
};

/// A robot in the middle of a cell is at a goal there, or at a place of a command.
inline constexpr double kPlaceToleranceM = 0.06;

/// So near to a goal in open terrain a robot has reached it.
inline constexpr double kOpenGoalM = 2.0;

/// The rules of a world: which commands a robot accepts, their outcome, what it has seen, which
/// goals it reached. Physics moves the robots; the caller takes the pictures.
///
/// Invariants: two robots never reserve one cell, and a robot is only in cells that it reserves; a
/// command ends by success, by a named failure or by its expiry, and then the robot
/// stands.
/// A move goes from cell to neighbouring cell, along the middles of cells; each leg begins when it
/// is free of walls and of other robots, else the command ends there.
/// In open terrain it goes straight from place to place; the robot looks ahead as far as it needs to
/// brake, and the command ends in front of an obstacle or another robot. A goal is reached within
/// kOpenGoalM, if no obstacle is between.
/// A drive action takes exactly one control step, after which the robot brakes unless the next
/// action has arrived. Time does not advance for braking alone, so a robot that gets commands
/// without pause keeps its speed from action to action. An action towards a wall or into a cell
/// that another robot reserves does not begin: the robot brakes for that step, and the outcome
/// gives the reason. Threads: one caller.
class Episode {
 public:
  /// `physics` outlives the episode; goals[i] belong to its robot i. Robots look around once.
  Episode(RobotWorld& physics, EpisodeOptions options);

  /// Where an episode was: as published, of each robot in order.
  struct Moment {
    struct Robot {
      RobotState state;
      MapUpdate map;
    };
    std::uint64_t steps = 0;  // of physics()
    std::vector<Robot> robots;
  };
  /// Goes on from there, right after construction: every robot stands at its place, and a command that
  /// was in force has expired (CommandGate). Doors close as they did.
  void Restore(Moment moment);

  /// Accepts a command or rejects it; the outcome is in the robot's state, the error is for the
  /// log. Errors: kNotFound (no such robot), and those of CommandGate; the state stays as it is.
  Result<void> Accept(const RobotCommand& command);
  /// Stops or resumes a robot; other robots' orders are ignored.
  void Accept(const StopOrder& order);

  /// Whether time must advance: some robot has a command in force or still rolls.
  bool active() const;

  /// One 4 Hz step of physics and its consequences. Robots whose view is due are in snapshots_due().
  /// `between`: see RobotWorld::Step.
  void Step(const std::function<void(int substep)>& between = nullptr);

  /// Robots that have turned to the heading of a transmit command and wait for CompleteView().
  std::vector<int> snapshots_due() const;
  /// Completes the view of `robot`: counts `jpeg_bytes` and starts a new path. Returns path and
  /// sequence number for the Snapshot, without pixels.
  Snapshot CompleteView(int robot, std::size_t jpeg_bytes);
  /// The same for a streamed snapshot, which ends no command.
  Snapshot TakeStreamedSnapshot(int robot);
  void CountFrame(int robot, std::size_t jpeg_bytes);
  /// A frame besides the method's, because somebody watches.
  void CountViewedFrame(int robot, std::size_t jpeg_bytes);

  SimTime now() const;
  int robot_count() const { return static_cast<int>(robots_.size()); }
  /// Driving or turning now, or as soon as time advances.
  bool moving(int robot) const;
  RobotState state(int robot) const;
  double goal_tolerance_m() const {
    return options_.open ? kOpenGoalM : physics_.geometry().cell_size_m / 2.0;
  }
  const MapUpdate& map(int robot) const;
  /// Increases with each change worth publishing.
  std::uint64_t state_version(int robot) const;
  const RobotWorld& physics() const { return physics_; }
  /// Changes when a door closes.
  int doors_closed() const { return static_cast<int>(closed_.size()); }

 private:
  /// -1: no robot has this name.
  int Find(const std::string& robot) const;
  RobotRecord& At(int robot);
  const RobotRecord& At(int robot) const;
  void Begin(int robot, bool started);
  void BeginMove(int robot);
  /// Why the robot cannot take the way of its command; empty = it can.
  std::string CheckWay(int robot) const;
  /// Drives to the first waypoint, or ends the command where the way is closed.
  void BeginLeg(int robot);
  void BeginOpenMove(int robot);
  void BeginOpenLeg(int robot);
  /// One step of a move in open terrain.
  void AdvanceOpen(int robot);
  /// Ends the command, and returns false, where the next metres towards the first place are closed.
  bool IsWayOpen(int robot);
  /// With the margin that is kept around it.
  double BodyRadius() const;
  /// How far ahead (negative: back) the robot stands if it brakes now.
  double BrakingWay(int robot) const;
  void ClaimNearGoals(int robot);
  void CloseDoors();
  void HideUnwantedGoals();
  /// At the end of a move or in place for a view: turns, or ends the move.
  void TurnOrFinish(int robot);
  void BeginView(int robot);
  void BeginDrive(int robot);
  DriveSpeeds SpeedsOf(DriveAction action) const;
  /// Whether the robot may drive to `reach`; if not, records the reason.
  bool MayDrive(int robot, Position reach);
  void EndDrive(int robot);
  /// Updates the cells that the axis entered since the last call, and those the body may touch
  /// until it stands.
  void TrackCells(int robot);
  void Halt(int robot);
  void Advance(int robot);
  void Arrive(int robot, Cell cell);
  void Finish(int robot, CommandOutcome outcome, std::string detail = {});
  /// The command in force is over: the robot brakes.
  void Rest(int robot);
  /// What its range sensor sees, and `obstacle`, in front of which it stands.
  void Observe(int robot, std::optional<Cell> obstacle = std::nullopt);
  void ClaimGoal(int robot, Cell cell);
  bool ReservedByAnother(int robot, Cell cell) const;
  std::vector<Position> HeldByOthers(int robot) const;
  bool Centred(int robot) const;
  /// Whether it stands between the centres of its cell and of its first waypoint, as after a stop or
  /// a restart.
  bool IsOnWay(int robot) const;
  Snapshot MakeSnapshot(int robot);

  RobotWorld& physics_;
  EpisodeOptions options_;
  std::vector<RobotRecord> robots_;
  std::vector<int> closed_;  // doors, by index
};

}  // namespace conav::sim
