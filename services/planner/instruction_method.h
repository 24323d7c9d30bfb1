#pragma once

#include "planner/follow_path.h"
#include "planner/method.h"

namespace conav::planner {

/// Instruction following (paper section 6.2): the robot goes along the operator's path cell by
/// cell. When the next cell is a wall, or the path is used up, it pauses and asks for new guidance.
/// Pictures are streamed.
class InstructionMethod final : public Method {
 public:
  Decision Decide(const Situation& situation) override;
  bool pictures_are_answered() const override { return false; }

 private:
  PathFollower follower_;
};

}  // namespace conav::planner
