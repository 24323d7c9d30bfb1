#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planner/experiment/search_experiment.h"

namespace conav::planner {

/// What one variant of a trade-off sweep is: a policy that decides on pictures, and its parameter.
struct TradeoffPoint {
  std::string policy;               // of kCommunicationPolicies, or "greedy"
  std::optional<double> parameter;  // search: the fixed part of c = 10 + m
};

/// Pictures against moves: IG-MCTS over costs of a picture, and every other communication policy
/// within the same planner over its parameter, in the same mazes. Points of one policy lie side by
/// side, in the order of their parameter.
struct TradeoffSweep {
  std::vector<TradeoffPoint> points;  // by variant
  SearchExperiment experiment;
};

/// The sweep of all policies, beside it the greedy robot; all search with `search`. Mazes and
/// operators are those of `experiment`, whose variants are not looked at.
TradeoffSweep MakeTradeoffSweep(const SearchConfig& search, SearchExperiment experiment);

/// What the parameter of `policy` is; empty without one.
std::string ParameterName(const std::string& policy);

}  // namespace conav::planner
