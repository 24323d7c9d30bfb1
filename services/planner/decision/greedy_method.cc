#include "planner/decision/greedy_method.h"

#include "planner/decision/traffic.h"

namespace conav::planner {

Decision GreedyMethod::Decide(const Situation& situation, const StopToken&) {
  std::vector<Cell> way = DesiredWay(situation);
  if (way.empty()) return {};
  if (IsTaken(situation, way.front()) || WaitsFor(situation, way) != nullptr) {
    return stand_off_.WaitOrStepOut(situation);
  }
  stand_off_.End();
  return MoveAlong(std::move(way));
}

std::vector<Cell> GreedyMethod::WayFor(const Situation& situation) { return DesiredWay(situation); }

}  // namespace conav::planner
