#include "planner/instruction_method.h"

#include "planner/traffic.h"

namespace conav::planner {
namespace {

/// Wall time for which a robot waits for another one to make room.
constexpr std::chrono::milliseconds kPatience{500};

}  // namespace

Decision InstructionMethod::Decide(const Situation& situation) {
  if (const auto aside = StepAside(situation)) return MoveAlong({*aside});
  if (situation.state.goals_left.empty()) return {};
  Decision decision = follower_.Next(situation);
  if (decision.action || decision.attention) {
    waiting_since_.reset();
    return decision;
  }
  if (!waiting_since_) waiting_since_ = clock_.Now();
  if (clock_.Now() - *waiting_since_ < kPatience) return decision;
  waiting_since_.reset();
  if (const auto cell = StepAnywhere(situation, random_)) return MoveAlong({*cell});
  return decision;
}

std::vector<Cell> InstructionMethod::WayFor(const Situation& situation) const {
  return situation.state.goals_left.empty() ? std::vector<Cell>{} : follower_.Rest();
}

}  // namespace conav::planner
