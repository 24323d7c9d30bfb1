#pragma once

#include <cstdint>
#include <optional>

#include "common/runtime/clock.h"
#include "common/runtime/random.h"
#include "planner/follow_path.h"
#include "planner/method.h"

namespace conav::planner {

/// Instruction following (paper section 6.2): the robot goes along the operator's path cell by
/// cell. When the next cell is a wall, or the path is used up, it pauses and asks for new guidance.
/// Pictures are streamed.
/// Robots that wait for each other for too long step out of the path at random and ask for a new
/// one.
class InstructionMethod final : public Method {
 public:
  explicit InstructionMethod(std::uint64_t seed) : random_(seed) {}

  Decision Decide(const Situation& situation) override;
  std::vector<Cell> WayFor(const Situation& situation) const override;
  bool pictures_are_answered() const override { return false; }

 private:
  PathFollower follower_;
  Random random_;
  SteadyClock clock_;
  std::optional<Clock::TimePoint> waiting_since_;  // for another robot to make room
};

}  // namespace conav::planner
