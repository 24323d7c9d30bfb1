#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "common/grid/geometry.h"
#include "common/msg/robot.h"
#include "common/runtime/result.h"
#include "sim/physics/robot_world.h"

namespace conav::sim {

/// What the simulator keeps of one robot besides its physics.
struct RobotRecord {
  RobotState state;       // as it will be published; stamp is filled in then
  MapUpdate map;          // what this robot has seen
  RobotCommand command;   // the last one taken up
  bool active = false;    // a command is in force
  bool braking = false;   // ended early, still rolling
  bool coasting = false;  // a drive action ended, still rolling: brakes when time goes on
  Position position;      // of the axis when its cells were looked at last
  CommandOutcome drive_outcome = CommandOutcome::kNone;  // of the drive action in force
  std::string drive_detail;
  std::deque<Cell> waypoints;  // cell centres still to be driven to, the command's target last
  std::vector<Cell> reserved;  // cells that no other robot may enter
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
};

/// The rules of a world: which commands a robot takes up, what comes of them, what it has seen,
/// which goals are reached. Physics moves the robots; pictures are taken by the caller.
///
/// Invariants: two robots never reserve one cell, and a robot is only in cells that it reserves; a
/// command ends by success, by a named failure or by its expiry, and then the robot stands.
/// A drive action takes exactly one control step, after which the robot brakes unless the next
/// action came: time does not go on for the sake of braking, so a robot that is driven as fast as
/// it is commanded keeps its speed from action to action. It is not begun towards a wall or into a
/// cell that another robot reserves: then the step is one of braking, and the outcome says why.
/// Threads: one caller.
class Episode {
 public:
  /// `physics` outlives the episode; goals[i] belong to its robot i. Robots look around once.
  Episode(RobotWorld& physics, EpisodeOptions options);

  /// Takes a command up, or refuses it: the outcome is in the robot's state. The error is for the
  /// log. Errors: kNotFound (no such robot), kRefused (old lease epoch or sequence number; the
  /// state stays as it is).
  Result<void> Accept(const RobotCommand& command);

  /// Whether time must go on because some robot has a command in force or still rolls.
  bool active() const;

  /// One 4 Hz step of physics, then what came of it. Robots whose view is due are in
  /// pictures_due().
  void Step();

  /// Robots that have turned to the heading of a transmit command and wait for CompleteView().
  std::vector<int> pictures_due() const;
  /// The picture of robot `robot` was taken: `jpeg_bytes` are counted, the path starts anew.
  /// Returns path and sequence number for the Picture, with its pixels left out.
  Snapshot CompleteView(int robot, std::size_t jpeg_bytes);
  /// The same for a streamed snapshot, which ends no command.
  Snapshot TakeStreamedSnapshot(int robot);
  void CountFrame(int robot, std::size_t jpeg_bytes);

  SimTime now() const;
  int robot_count() const { return static_cast<int>(robots_.size()); }
  /// Driving or turning right now, or about to when time goes on.
  bool moving(int robot) const;
  RobotState state(int robot) const;
  const MapUpdate& map(int robot) const;
  /// Rises with each change that is worth publishing.
  std::uint64_t state_version(int robot) const;
  const RobotWorld& physics() const { return physics_; }

 private:
  RobotRecord& At(int robot);
  const RobotRecord& At(int robot) const;
  void Begin(int robot);
  void BeginMove(int robot);
  void BeginView(int robot);
  void BeginDrive(int robot);
  DriveSpeeds SpeedsOf(DriveAction action) const;
  /// Whether the robot may drive to `reach`; else says in its record why not.
  bool MayDrive(int robot, Position reach);
  void EndDrive(int robot);
  /// Cells that the axis entered since the last look, and what the body may touch until it stands.
  void TrackCells(int robot);
  void Halt(int robot);
  void Advance(int robot);
  void Arrive(int robot, Cell cell);
  void Finish(int robot, CommandOutcome outcome, std::string detail = {});
  void Observe(int robot);
  void ClaimGoal(int robot, Cell cell);
  bool ReservedByAnother(int robot, Cell cell) const;
  bool Centred(int robot) const;
  Snapshot MakeSnapshot(int robot);

  RobotWorld& physics_;
  EpisodeOptions options_;
  std::vector<RobotRecord> robots_;
  std::vector<bool> turned_;  // a view's heading is reached
  std::vector<std::uint64_t> versions_;
};

}  // namespace conav::sim
