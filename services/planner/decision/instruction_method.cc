#include "planner/decision/instruction_method.h"

namespace conav::planner {

Decision InstructionMethod::Decide(const Situation& situation, const StopToken&) {
  if (situation.state.goals_left.empty()) return {};
  return follower_.Next(situation);
}

std::vector<Cell> InstructionMethod::WayFor(const Situation& situation) {
  return follower_.Rest(situation);
}

}  // namespace conav::planner
