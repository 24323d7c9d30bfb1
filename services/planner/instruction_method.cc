#include "planner/instruction_method.h"

#include "planner/traffic.h"

namespace conav::planner {

Decision InstructionMethod::Decide(const Situation& situation) {
  if (const auto aside = StepAside(situation)) return MoveAlong({*aside});
  if (situation.state.goals_left.empty()) return {};
  return follower_.Next(situation);
}

}  // namespace conav::planner
