#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/grid/geometry.h"
#include "common/grid/grid.h"
#include "common/grid/visibility.h"
#include "common/runtime/clock.h"

/// Domain values of the robot's side of the bus; idl/conav_robot.idl states who sends them and
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
  Cell target;               // move: a neighbour of the robot's cell
  double heading_rad = 0.0;  // transmit view
  DriveAction drive = DriveAction::kStop;
  std::uint64_t drive_order = 0;  // drive: sequence number of the DriveOrder behind it
  bool operator==(const RobotCommand&) const = default;
};

enum class CommandOutcome : std::uint8_t {
  kNone,
  kRunning,
  kDone,
  kBlocked,   // the target cell, or one driven towards, is a wall
  kOccupied,  // another robot stands there or is driving there
  kRefused,
  kExpired,
};

struct RobotState {
  SimTime stamp;
  std::string world;
  std::string robot;
  Cell cell;
  double heading_rad = 0.0;
  Position position;
  std::vector<Cell> goals_left;
  std::vector<Cell> goals_reached;
  std::uint32_t goals_total = 0;
  std::vector<Cell>
      path;  // since the last picture, that picture's cell first, the current cell last
  std::uint64_t command_sequence_number = 0;
  CommandOutcome command_outcome = CommandOutcome::kNone;
  std::string command_detail;
  Cell command_cell;
  std::uint64_t drive_order = 0;  // of the last DriveOrder accepted
  std::uint64_t lease_epoch = 0;
  std::uint64_t cell_moves = 0;
  std::uint64_t low_level_steps = 0;
  std::uint64_t images = 0;
  std::uint64_t image_bytes = 0;
  std::uint64_t snapshots = 0;  // sequence number of the newest Snapshot; 0 = none yet
  SimTime map_stamp;            // of the newest map of this robot
  bool operator==(const RobotState&) const = default;
};

/// A picture that a robot sent, and the cells it shows.
struct Snapshot {
  SimTime stamp;
  std::string world;
  std::string robot;
  std::uint64_t sequence_number = 0;
  bool streamed = false;
  Cell cell;
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
