#include "planner/instruction_method.h"

#include "planner/follow_path.h"

namespace conav::planner {

Decision InstructionMethod::Decide(const Situation& situation) {
  if (situation.state.goals_left.empty()) return {};
  return FollowPath(situation);
}

}  // namespace conav::planner
