#pragma once

#include <cstdint>

#include "planner/decision/follow_path.h"
#include "planner/decision/method.h"

namespace conav::planner {

/// Instruction following (paper section 6.2): the robot goes along the operator's path cell by
/// cell. When the next cell is a wall, or the path is used up, it pauses and asks for new guidance.
/// Pictures are streamed.
class InstructionMethod final : public Method {
 public:
  InstructionMethod(std::uint64_t seed, const Clock& clock) : follower_(seed, clock) {}

  Decision Decide(const Situation& situation, const StopToken& stop) override;
  std::vector<Cell> WayFor(const Situation& situation) override;
  AwaitedInput awaits() const override { return AwaitedInput::kGuidance; }

 private:
  PathFollower follower_;
};

}  // namespace conav::planner
