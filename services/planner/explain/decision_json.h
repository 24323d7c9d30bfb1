#pragma once

#include <nlohmann/json.hpp>
#include <span>

#include "planner/explain/decision_text.h"

namespace conav::planner {

/// Everything that was recorded of a decision, and why; cells as [row, column], headings in rad.
nlohmann::ordered_json DecisionJson(const DecisionRecord& decision);

nlohmann::ordered_json ListJson(std::span<const DecisionSummary> decisions);

}  // namespace conav::planner
