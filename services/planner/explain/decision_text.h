#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "planner/explain/decision_file.h"

namespace conav::planner {

/// Situation, root actions by visits with value and terms, and why; the action taken is marked *.
std::string DecisionText(const DecisionRecord& decision);

/// What a list says of a decision.
struct DecisionSummary {
  std::string robot;
  std::uint64_t number = 0;
  double time_s = 0.0;
  Cell cell;
  std::string action;
  bool picture = false;
  bool searched = false;
  double visit_share = 0.0;  // of the action taken
  double value = 0.0;
  double margin = 0.0;            // see Margin()
  double information_gain = 0.0;  // of a picture
};

DecisionSummary Summarise(const DecisionRecord& decision);

/// A line for each.
std::string ListText(std::span<const DecisionSummary> decisions);

/// Everything that was recorded of a decision, and why; cells as [row, column], headings in rad.
nlohmann::ordered_json DecisionJson(const DecisionRecord& decision);

nlohmann::ordered_json ListJson(std::span<const DecisionSummary> decisions);

}  // namespace conav::planner
