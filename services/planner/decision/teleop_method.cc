#include "planner/decision/teleop_method.h"

namespace conav::planner {

Decision TeleopMethod::Decide(const Situation& situation, const StopToken&) {
  Decision decision;
  const auto& order = situation.drive;
  // The robot itself may have carried it out for a planner that is gone.
  if (!order || order->sequence_number == newest_order_ ||
      order->sequence_number == situation.state.drive_order) {
    return decision;
  }
  newest_order_ = order->sequence_number;
  if (order->expires_at <= situation.now) return decision;
  Action& action = decision.action.emplace();
  action.kind = CommandKind::kDrive;
  action.target = situation.state.cell;
  action.drive = order->drive;
  action.drive_order = order->sequence_number;
  action.expires_at = order->expires_at;
  return decision;
}

}  // namespace conav::planner
