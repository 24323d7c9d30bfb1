#include "planner/decision/stand_off.h"

#include "planner/decision/traffic.h"

namespace conav::planner {

Decision StandOff::WaitOrStepOut(const Situation& situation) {
  if (!since_) since_ = clock_.Now();
  if (clock_.Now() - *since_ < kPatience) return {};
  since_.reset();
  if (const auto cell = StepAnywhere(situation, random_)) return MoveAlong({*cell});
  return {};
}

}  // namespace conav::planner
