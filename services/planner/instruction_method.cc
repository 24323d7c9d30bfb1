#include "planner/instruction_method.h"

#include "planner/follow_path.h"
#include "planner/traffic.h"

namespace conav::planner {

Decision InstructionMethod::Decide(const Situation& situation) {
  if (const auto aside = StepAside(situation)) return MoveAlong({*aside});
  if (situation.state.goals_left.empty()) return {};
  return FollowPath(situation);
}

}  // namespace conav::planner
