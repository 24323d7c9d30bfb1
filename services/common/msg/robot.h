#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/grid/geometry.h"
#include "common/grid/grid.h"
#include "common/grid/visibility.h"
#include "common/runtime/clock.h"

/// Domain values of the robot's side of the bus; idl/conav_msgs states who sends them and
/// when.
namespace conav {

/// Names of worlds and robots become parts of topics: 1 to kMaxName of A-Z a-z 0-9 _.
inline constexpr std::size_t kMaxName = 64;

inline bool IsNameCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

inline bool IsEntityName(std::string_view name) {
  return !name.empty() && name.size() <= kMaxName &&
         std::all_of(name.begin(), name.end(), IsNameCharacter);
}

/// An occupancy map with its place in the world.
struct MapUpdate {
  SimTime stamp;
  double cell_size_m = 2.0;
  OccupancyGrid cells;
  Position middle{};  // of the grid, in the map frame

  GridGeometry geometry() const { return {cells.rows(), cells.columns(), cell_size_m, middle}; }
  bool operator==(const MapUpdate&) const = default;
};

enum class CommandKind : std::uint8_t { kStop, kMove, kTransmitView, kDrive };

/// A low-level action: what the robot does during one control step of 0.25 s.
enum class DriveAction : std::uint8_t { kStop, kForward, kBackward, kTurnLeft, kTurnRight };

/// In force until done, replaced or expired.
struct RobotCommand {
  SimTime stamp;
  std::string robot;
  std::uint64_t sequence_number = 0;
  std::uint64_t lease_epoch = 0;
  SimTime expires_at;
  CommandKind kind = CommandKind::kStop;
  std::vector<Position> path;  // move: along these places, the destination last
  double tolerance_m = 0.0;    // move: a place is reached when the robot's axis is this near
  std::optional<double> arrival_heading_rad;  // move: to end with
  double heading_rad = 0.0;                   // transmit view
  DriveAction drive = DriveAction::kStop;
  std::uint64_t drive_order = 0;  // drive: sequence number of the DriveOrder behind it
  bool operator==(const RobotCommand&) const = default;
};

enum class CommandOutcome : std::uint8_t {
  kNone,
  kRunning,
  kDone,
  kBlocked,   // an obstacle lies on the way
  kOccupied,  // another robot stands on the way or is driving there
  kRefused,   // the robot cannot carry it out
  kExpired,
  kStopped,  // a person has stopped the robot
};

/// A robot as it reports itself. The wire speaks of places in metres; cells are those of the robot's
/// map.
struct RobotState {
  SimTime stamp;
  std::string world;
  std::string robot;
  GridGeometry grid;  // of the robot's newest map
  Cell cell;          // of the newest place of `path`: until the robot arrives, where it left
  double heading_rad = 0.0;
  Position position;
  double speed_mps = 0.0;     // along the heading, forward positive
  double yaw_rate_rps = 0.0;  // counter-clockwise positive
  SimTime goals_stamp;  // of the goals that belong to this state; 0 = the robot does not keep them
  // The next three come on a topic of their own: GoalsJoin fills them in.
  std::vector<Cell> goals_left;
  std::vector<Cell> goals_reached;
  std::uint32_t goals_total = 0;
  std::vector<Cell>
      path;  // since the last picture, that picture's cell first, the current cell last
  std::uint64_t command_sequence_number = 0;
  CommandOutcome command_outcome = CommandOutcome::kNone;
  std::string command_detail;
  Cell command_cell;  // destination of the last command, or the cell found blocked or occupied
  std::uint64_t drive_order = 0;  // of the last DriveOrder accepted
  std::uint64_t lease_epoch = 0;
  std::uint64_t cell_moves = 0;
  double distance_m = 0.0;  // driven since the start
  std::uint64_t low_level_steps = 0;
  std::uint64_t images = 0;
  std::uint64_t image_bytes = 0;
  std::uint64_t camera_bytes = 0;   // of frames besides these, for viewers of the camera
  std::uint64_t snapshots = 0;      // sequence number of the newest Snapshot; 0 = none yet
  SimTime map_stamp;                // of the newest map of this robot
  bool stopped = false;             // the robot itself stands until a person resumes it
  std::uint64_t stop_revision = 0;  // of the newest StopOrder that it took; 0 = none yet
  bool operator==(const RobotState&) const = default;
};

/// The goals of a robot, in any order of visit.
struct RobotGoals {
  SimTime stamp;  // rises with each change
  std::string world;
  std::string robot;
  std::vector<Position> left;
  std::vector<Position> reached;  // by this robot, in order
  std::uint32_t total = 0;        // left + reached of all robots that share them
  double tolerance_m = 0.0;       // a goal is reached when the robot's axis is this near
  bool operator==(const RobotGoals&) const = default;
};

/// What the simulator publishes of a robot whose goals it keeps.
RobotGoals GoalsOf(const RobotState& state, double tolerance_m);

/// Whether a robot that does not keep its goals itself has reached `goal` with this state: it is within
/// `tolerance_m`, or has arrived in the goal's cell of its map, which is as near as planners drive.
bool Reaches(const RobotState& state, Position goal, double tolerance_m);

/// Joins the states of one robot with its goals, so that a user never sees a state with goals of
/// another moment: a goal that a state reaches is left no longer, also before the keeper of the
/// goals says so, which it does with a stamp from that state on. Threads: one caller.
class GoalsJoin {
 public:
  /// `state` with its goals; nothing while the goals that belong to it have not come.
  std::optional<RobotState> Receive(RobotState state);
  /// The newest state with these goals, where they belong to it, or where the robot does not keep
  /// its goals.
  std::optional<RobotState> Receive(RobotGoals goals);

 private:
  std::optional<RobotState> Joined() const;

  struct Reached {
    Position goal;
    SimTime stamp;  // of the state that reached it
  };

  bool keeps_goals() const { return state_->goals_stamp != SimTime{}; }
  void NoteReached();

  std::optional<RobotState> state_;
  std::optional<RobotGoals> goals_;
  std::vector<Reached> reached_;  // not yet reached by goals_; empty where the robot keeps them
};

/// A picture that a robot sent, and the cells of its map that it shows.
struct Snapshot {
  SimTime stamp;
  std::string world;
  std::string robot;
  std::uint64_t sequence_number = 0;
  bool streamed = false;
  GridGeometry grid;  // of the robot's map
  Cell cell;          // of the newest place of `path`, as in RobotState
  Position position;
  double heading_rad = 0.0;
  double horizontal_fov_rad = 0.0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> jpeg;  // empty when streamed, or when the simulator has no camera
  VisibleCells visible;
  std::vector<Cell> path;  // since the picture before, that picture's cell first
  std::vector<Cell> goals_left;
  bool operator==(const Snapshot&) const = default;
};

}  // namespace conav
