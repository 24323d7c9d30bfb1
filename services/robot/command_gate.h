#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/grid/geometry.h"
#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/result.h"

// One user: the simulator; drivers of real robots include it, too.

namespace conav::robot {

/// Cells of the path in a robot's state: the oldest leave, so that the states of a robot that sends no
/// pictures do not grow for ever.
inline constexpr std::size_t kLongestPath = 4096;

/// The robot enters `cell`.
inline void Extend(std::vector<Cell>& path, Cell cell) {
  if (path.size() >= kLongestPath) path.erase(path.begin());
  path.push_back(cell);
}

/// Which commands a robot carries out, and for how long: the contract of docs/robots.md, without
/// bus, clock and motors. The simulator's robots use it, and so does a driver of a real robot.
///
/// - A command of an older lease epoch, or of the newest epoch with an older sequence number, is
///   rejected and changes nothing, and so is one whose epoch, or sequence number in its epoch, is
///   more than kMaxCounterStep ahead: it would shut out planners for good. A repeat of the newest
///   one changes nothing.
/// - A command is in force until End(), its expiry, the next command or a stop. Silence never means
///   go on.
/// - A stop is latched: the robot stands, whatever the epoch of a command, until an order to resume
///   arrives that is newer than the stop. A stop is taken whatever its revision: to stand is safe.
///   But one more than kMaxCounterStep ahead is not counted, so that a newer order can follow, and
///   no order resumes from there.
///
/// - Right of way: a robot drives to no place that another robot holds (IsClear()).
///
/// Times: the robot's clock, which is simulation time in an episode. Threads: one caller.
class CommandGate {
 public:
  explicit CommandGate(std::string robot) : robot_(std::move(robot)) {}

  enum class Admission : std::uint8_t {
    kStarted,   // command() is in force; it replaced what was
    kRepeated,  // known already
    kEnded,     // accepted, and over: it has expired, or the robot is stopped
  };
  /// When this is kEnded the robot stands. Errors: kRefused (of another robot; lease epoch or
  /// sequence number old or too far ahead), which names the value and the limit.
  [[nodiscard]] Result<Admission> Receive(const RobotCommand& command, SimTime now);
  /// Returns whether the order ended a command, so that the robot has to brake. Ignores orders for
  /// other robots, and an order to resume that is not newer than the stop or too far ahead.
  bool Receive(const StopOrder& order);

  /// Goes on from what it reported before the robot's program died. A command that was in force is
  /// over, as expired: its planner decides again at once.
  void Restore(const RobotState& state);

  /// The command in force ended like this; `detail` says why where it is no success.
  void End(CommandOutcome outcome, std::string detail = {});
  /// Ends a command in force that was not done by its expiry; returns whether it did.
  bool EndIfExpired(SimTime now);

  /// The places that other robots hold: where they stand, and where they are driving.
  void SetHeldByOthers(std::vector<Position> places) { held_by_others_ = std::move(places); }
  /// Whether the straight way stays at least `clearance_m` away from all of these places; moving
  /// away from one that is nearer is allowed.
  bool IsClear(Position from, Position to, double clearance_m) const;

  bool active() const { return outcome_ == CommandOutcome::kRunning; }
  bool stopped() const { return stopped_; }
  /// The last one accepted, in force or not.
  const RobotCommand& command() const { return command_; }

  /// Writes what the robot reports of its commands: lease epoch, sequence number, outcome, drive
  /// order, and whether it is stopped.
  void Report(RobotState& state) const;

 private:
  std::string robot_;
  RobotCommand command_;
  CommandOutcome outcome_ = CommandOutcome::kNone;
  std::string detail_;
  std::uint64_t drive_order_ = 0;
  std::uint64_t stop_revision_ = 0;  // of the newest order counted
  bool stopped_ = false;
  std::vector<Position> held_by_others_;
};

}  // namespace conav::robot
