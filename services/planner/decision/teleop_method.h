#pragma once

#include <cstdint>

#include "planner/decision/method.h"

namespace conav::planner {

/// Teleoperation: each low-level action of whoever steers the robot is passed on once, under this
/// planner's lease and with the order's own expiry; an order that came too late is left out.
/// Nothing is decided here: without orders the robot stands, and where robots meet it is the
/// operator's to make room. Of several orders that arrive while an action is carried out, the
/// newest counts. Guidance is not followed. Pictures are streamed. Source: paper section 6.2.
class TeleopMethod final : public Method {
 public:
  Decision Decide(const Situation& situation, const StopToken& stop) override;
  std::vector<Cell> WayFor(const Situation&) override { return {}; }
  AwaitedInput awaits() const override { return AwaitedInput::kBelief; }
  bool is_steered() const override { return true; }

 private:
  std::uint64_t newest_order_ = 0;  // passed on, or too late
};

}  // namespace conav::planner
