#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "planner/record/decision_record.h"

namespace conav::planner {

/// The terms of a value with their names, in the order in which they are shown.
using NamedTerms = std::array<std::pair<const char*, double>, 7>;
NamedTerms Named(const RewardTerms& terms);

/// The root's actions by visits, then value, then their order; those that were never tried last.
std::vector<SearchAction> RankedActions(const SearchReport& report);

/// What `decision` commanded as the search saw it; null when no search offered it.
const SearchAction* TakenAction(const DecisionRecord& decision);

/// The most visited other action; null when no other was tried.
const SearchAction* RunnerUp(const DecisionRecord& decision);

/// Value of the action taken less that of the runner-up; 0 without one.
double Margin(const DecisionRecord& decision);

/// Why the robot did what it did, in sentences made from the figures of the decision.
std::vector<std::string> Why(const DecisionRecord& decision);

}  // namespace conav::planner
