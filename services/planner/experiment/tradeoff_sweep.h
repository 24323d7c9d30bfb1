#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planner/experiment/search_experiment.h"

namespace conav::planner {

/// What pictures are weighed against.
enum class Effort { kSteps, kMoves };  // EstimatedLowLevelSteps, or cells entered

/// What one variant of a trade-off sweep is: a policy that decides on pictures, and its parameter.
struct TradeoffPoint {
  std::string policy;               // of kCommunicationPolicies, or "greedy"
  std::optional<double> parameter;  // search: RewardOptions::communication_cost
};

/// Pictures against effort: IG-MCTS over costs of a picture, and every other communication policy
/// within the same planner over its parameter, in the same mazes. Points of one policy lie side by
/// side, in the order of their parameter.
struct TradeoffSweep {
  std::vector<TradeoffPoint> points;  // by variant
  Effort effort = Effort::kSteps;
  SearchExperiment experiment;
};

/// The sweep of all policies, beside it the greedy robot; all search with `search`. Mazes and
/// operators are those of `experiment`, whose variants are not looked at.
/// `turn_cost`: CommunicationConfig::turn_cost of the other policies.
TradeoffSweep MakeTradeoffSweep(const SearchConfig& search, SearchExperiment experiment,
                                double turn_cost = 0.0);

/// What the parameter of `policy` is; empty without one.
std::string ParameterName(const std::string& policy);

}  // namespace conav::planner
