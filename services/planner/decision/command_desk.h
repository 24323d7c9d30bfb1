#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "common/protocol/robot.h"
#include "planner/decision/method.h"

namespace conav::planner {

/// Writes a robot's commands: sequence numbers, lease epoch, expiry, and the repeat of a command
/// that the robot has not taken up. Threads: one worker's.
class CommandDesk {
 public:
  CommandDesk(std::string robot, std::chrono::nanoseconds ttl)
      : robot_(std::move(robot)), ttl_(ttl) {}

  /// Begins anew under a lease; epoch 0 = one above the robot's, taken with the first command.
  void Begin(std::uint64_t lease_epoch);

  /// The next command.
  RobotCommand Issue(const Action& action, const RobotState& state, SimTime now);

  /// Whether the robot took up the last command. Another planner's may have its number, but not its
  /// epoch.
  bool IsShownBy(const RobotState& state) const;

  /// The last command, when the robot shows another one; with a fresh expiry unless it
  /// is a low-level action, which nobody wants late.
  std::optional<RobotCommand> Repeat(const RobotState& state, SimTime now);

  /// 0 before the first command.
  std::uint64_t sent_sequence_number() const { return last_.sequence_number; }
  std::uint64_t lease_epoch() const { return last_.lease_epoch; }
  /// Of the last command; kStop also before the first.
  CommandKind last_kind() const { return last_.kind; }

 private:
  std::string robot_;
  std::chrono::nanoseconds ttl_;
  RobotCommand last_;
};

}  // namespace conav::planner
