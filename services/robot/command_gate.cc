#include "robot/command_gate.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace conav::robot {

Result<CommandGate::Admission> CommandGate::Receive(const RobotCommand& command, SimTime now) {
  if (command.robot != robot_) {
    return Fail(ErrorCode::kRefused, fmt::format("robot = '{}' is not {}", command.robot, robot_));
  }
  if (command.lease_epoch < command_.lease_epoch) {
    return Fail(ErrorCode::kRefused,
                fmt::format("lease_epoch = {} is older than {}, the newest that {} has seen",
                            command.lease_epoch, command_.lease_epoch, robot_));
  }
  if (command.lease_epoch - command_.lease_epoch > kMaxCounterStep) {
    return Fail(
        ErrorCode::kRefused,
        fmt::format("lease_epoch = {} is more than {} above {}, the newest that {} has seen",
                    command.lease_epoch, kMaxCounterStep, command_.lease_epoch, robot_));
  }
  const bool same_lease = command.lease_epoch == command_.lease_epoch;
  if (same_lease && command.sequence_number == command_.sequence_number) {
    return Admission::kRepeated;
  }
  if (same_lease && command.sequence_number < command_.sequence_number) {
    return Fail(ErrorCode::kRefused,
                fmt::format("sequence_number = {} is older than {}, the last that {} accepted",
                            command.sequence_number, command_.sequence_number, robot_));
  }
  if (same_lease && command.sequence_number - command_.sequence_number > kMaxCounterStep) {
    return Fail(
        ErrorCode::kRefused,
        fmt::format("sequence_number = {} is more than {} above {}, the last that {} "
                    "accepted",
                    command.sequence_number, kMaxCounterStep, command_.sequence_number, robot_));
  }
  command_ = command;
  outcome_ = CommandOutcome::kRunning;
  detail_.clear();
  if (command.kind == CommandKind::kDrive) drive_order_ = command.drive_order;
  if (command.expires_at <= now) {
    End(CommandOutcome::kExpired, fmt::format("expired at {:.3f} s; the time is {:.3f} s",
                                              command.expires_at.ToSeconds(), now.ToSeconds()));
  } else if (stopped_ && command.kind != CommandKind::kStop) {
    End(CommandOutcome::kStopped, "a person has stopped the robot");
  }
  return active() ? Admission::kStarted : Admission::kEnded;
}

bool CommandGate::Receive(const StopOrder& order) {
  if (order.robot != robot_) return false;
  const bool newer = order.revision > stop_revision_;
  const bool counts = newer && order.revision - stop_revision_ <= kMaxCounterStep;
  if (!order.stopped && !counts) return false;
  stopped_ = order.stopped;
  if (counts) stop_revision_ = order.revision;
  if (!stopped_ || !active()) return false;
  End(CommandOutcome::kStopped, "a person has stopped the robot");
  return true;
}

void CommandGate::End(CommandOutcome outcome, std::string detail) {
  outcome_ = outcome;
  detail_ = std::move(detail);
}

bool CommandGate::EndIfExpired(SimTime now) {
  if (!active() || now < command_.expires_at) return false;
  End(CommandOutcome::kExpired,
      fmt::format("not done by {:.3f} s", command_.expires_at.ToSeconds()));
  return true;
}

bool CommandGate::IsClear(Position from, Position to, double clearance_m) const {
  const double dx = to.x_m - from.x_m;
  const double dy = to.y_m - from.y_m;
  const double squared = dx * dx + dy * dy;
  return std::ranges::all_of(held_by_others_, [&](Position held) {
    const double along = (held.x_m - from.x_m) * dx + (held.y_m - from.y_m) * dy;
    const double share = squared > 0.0 ? std::clamp(along / squared, 0.0, 1.0) : 0.0;
    if (share == 0.0 && squared > 0.0) return true;  // it lies behind
    return std::hypot(from.x_m + share * dx - held.x_m, from.y_m + share * dy - held.y_m) >=
           clearance_m;
  });
}

void CommandGate::Restore(const RobotState& state) {
  const bool was_running = state.command_outcome == CommandOutcome::kRunning;
  command_ = {};
  command_.robot = robot_;
  command_.lease_epoch = state.lease_epoch;
  command_.sequence_number = state.command_sequence_number;
  outcome_ = was_running ? CommandOutcome::kExpired : state.command_outcome;
  detail_ = was_running ? "the robot's program started again" : state.command_detail;
  drive_order_ = state.drive_order;
  stopped_ = state.stopped;
  stop_revision_ = state.stop_revision;
}

void CommandGate::Report(RobotState& state) const {
  state.lease_epoch = command_.lease_epoch;
  state.command_sequence_number = command_.sequence_number;
  state.command_outcome = outcome_;
  state.command_detail = detail_;
  state.drive_order = drive_order_;
  state.stopped = stopped_;
  state.stop_revision = stop_revision_;
}

}  // namespace conav::robot
