#include "planner/experiment/tradeoff_sweep.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace conav::planner {
namespace {

constexpr double kCosts[]{0.0, 0.125, 0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 50.0};
constexpr double kProbabilities[]{0.02, 0.05, 0.1, 0.2, 0.4, 0.8};
constexpr double kEveryMoves[]{1.0, 2.0, 3.0, 5.0, 8.0, 12.0, 20.0};
constexpr double kThresholds[]{0.1, 0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0};

void Add(TradeoffSweep& sweep, const SearchConfig& search, const std::string& policy,
         std::optional<double> parameter) {
  SearchVariant variant;
  variant.name = policy;
  variant.config = search;
  if (parameter) variant.name = fmt::format("{} {:g}", policy, *parameter);
  if (policy == "greedy") {
    variant.method = policy;
  } else {
    variant.communication.policy = policy;
  }
  const double value = parameter.value_or(0.0);
  if (policy == "search") variant.config.options.reward.communication_cost = value;
  if (policy == "random") variant.communication.probability = value;
  if (policy == "every") variant.communication.every_moves = static_cast<int>(std::lround(value));
  if (policy == "threshold") variant.communication.threshold_cells = value;
  sweep.points.push_back({policy, parameter});
  sweep.experiment.variants.push_back(std::move(variant));
}

}  // namespace

TradeoffSweep MakeTradeoffSweep(const SearchConfig& search, SearchExperiment experiment,
                                double turn_cost) {
  TradeoffSweep sweep;
  sweep.experiment = std::move(experiment);
  sweep.experiment.variants.clear();
  for (const double cost : kCosts) Add(sweep, search, "search", cost);
  for (const double probability : kProbabilities) Add(sweep, search, "random", probability);
  for (const double moves : kEveryMoves) Add(sweep, search, "every", moves);
  for (const double cells : kThresholds) Add(sweep, search, "threshold", cells);
  for (const char* policy : {"when_blocked", "never", "greedy"}) {
    Add(sweep, search, policy, std::nullopt);
  }
  for (SearchVariant& variant : sweep.experiment.variants) {
    variant.communication.turn_cost = turn_cost;
  }
  return sweep;
}

std::string ParameterName(const std::string& policy) {
  if (policy == "search") return "cost of a picture";
  if (policy == "random") return "probability per decision";
  if (policy == "every") return "moves";
  if (policy == "threshold") return "expected edits";
  return "";
}

}  // namespace conav::planner
