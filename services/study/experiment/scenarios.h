#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "study/experiment/search_experiment.h"

// One user: the command; what counts as "the person matters" is what readers look for.
namespace conav::planner {

/// The methods of scenarios.yaml in one scenario, and what they show.
struct ScenarioResult {
  SearchExperiment experiment;  // its variants are the methods
  std::vector<ExperimentEpisode> episodes;
};

/// How IG-MCTS with NHPM compares in a scenario, over the mazes with one kind of operator. Steps of an
/// episode without all goals are those of its limit.
struct ScenarioVerdict {
  /// At least kLeastSaving fewer steps than greedy and than never-send, the bootstrap intervals of the
  /// means apart; or all goals in every maze where never-send misses some. And more pictures with every
  /// rule that needs at most kEqualSteps times its steps.
  bool person_matters = false;
  /// Fewer steps, or fewer pictures at kEqualSteps times the steps at most, than with GLPF in the same
  /// search: the interval of the paired difference lies below 0.
  bool perception_matters = false;
  double steps_over_greedy = 0.0;
  double steps_over_never = 0.0;
  std::string reason;  // what is missing for person_matters
};
inline constexpr double kLeastSaving = 0.15;
inline constexpr double kEqualSteps = 1.02;

/// Requires the methods ig-mcts, ig-mcts-glpf, greedy and never. `person`: index of the operator.
ScenarioVerdict Judge(const ScenarioResult& result, std::size_t person);

/// A line per method and operator, and the verdict of each operator.
std::string ScenarioTable(const ScenarioResult& result);

/// {"experiment": "scenarios", "operators": "simulated", ..., "person_matters": [NAME, ...],
/// "perception_matters": [...], "scenarios": {NAME: {METHOD: {"steps_mean", "bytes_mean",
/// "pictures_mean", "mapping_accuracy_mean", "goals_reached_fraction", "moves_mean", "guidance_mean",
/// "operators": {KIND: the same with intervals}}}}}. Bytes are pictures of 180 KiB, as the paper counts.
/// The two lists are by the first operator.
nlohmann::ordered_json ScenariosJson(const std::vector<ScenarioResult>& results);

/// A line per episode: scenario, method, then kEpisodeColumns and steps.
std::string ScenariosCsv(const std::vector<ScenarioResult>& results);

}  // namespace conav::planner
