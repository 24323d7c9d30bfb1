#include "planner/decision/method.h"

namespace conav::planner {

Decision MoveAlong(std::vector<Cell> plan) {
  Decision decision;
  decision.action = Action{CommandKind::kMove, plan.front(), 0.0};
  decision.report.actions.push_back({.target = plan.front(), .visits = 1});
  decision.report.chosen = 0;
  decision.plan = std::move(plan);
  return decision;
}

}  // namespace conav::planner
