#pragma once

#include <optional>
#include <string>

#include "planner/decision/blackboard.h"

namespace conav::planner {

/// What is wrong with inputs that are well-formed one by one but do not belong together, for
/// example an operator's map of another building. The text names both sides and their values;
/// nothing when all fits. Needs state and map; the rest is looked at where it is there.
std::optional<std::string> Inconsistency(const RobotInputs& inputs);

}  // namespace conav::planner
