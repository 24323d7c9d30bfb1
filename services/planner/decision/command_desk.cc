#include "planner/decision/command_desk.h"

#include <algorithm>

namespace conav::planner {

void CommandDesk::Begin(std::uint64_t lease_epoch) {
  last_ = {};
  last_.lease_epoch = lease_epoch;
}

RobotCommand CommandDesk::Issue(const Action& action, const RobotState& state, SimTime now) {
  last_.robot = robot_;
  last_.lease_epoch = last_.lease_epoch == 0 ? state.lease_epoch + 1 : last_.lease_epoch;
  last_.sequence_number = std::max(last_.sequence_number, state.command_sequence_number) + 1;
  last_.stamp = now;
  last_.expires_at = action.kind == CommandKind::kDrive ? action.expires_at : now + ttl_;
  last_.kind = action.kind;
  last_.target = action.target;
  last_.heading_rad = action.heading_rad;
  last_.drive = action.drive;
  last_.drive_order = action.drive_order;
  return last_;
}

bool CommandDesk::IsShownBy(const RobotState& state) const {
  return state.command_sequence_number == last_.sequence_number &&
         state.lease_epoch == last_.lease_epoch;
}

std::optional<RobotCommand> CommandDesk::Repeat(const RobotState& state, SimTime now) {
  if (last_.sequence_number == 0 || IsShownBy(state)) return std::nullopt;
  last_.stamp = now;
  if (last_.kind != CommandKind::kDrive) last_.expires_at = now + ttl_;
  return last_;
}

}  // namespace conav::planner
