#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "study/experiment/search_experiment.h"
#include "study/experiment/tradeoff.h"

/// What `conav experiment search` says of its episodes.
namespace conav::planner {

/// A line per variant and kind of operator.
std::string ExperimentTable(const SearchExperiment& experiment,
                            const std::vector<VariantSummary>& summaries);

/// {"experiment": "search", "operator": "simulated", "seeds", ..., "rows": [{"variant",
/// "operator", "all_goals", "episodes", and for goals_share, moves, moves_ratio, pictures,
/// turning_rad, mapping_accuracy: {"mean", "low", "high"}, "decision_ms_p50", "decision_ms_p95"}]}.
/// moves_ratio is null where no episode reached all goals.
nlohmann::ordered_json ExperimentJson(const SearchExperiment& experiment,
                                      const std::vector<VariantSummary>& summaries);

/// A line per episode: variant, operator, seed, all_goals, goals_reached, moves, optimal_moves,
/// blocked, pictures, guidance, edits, mapping_accuracy, turning_rad.
std::string ExperimentCsv(const SearchExperiment& experiment,
                          const std::vector<ExperimentEpisode>& episodes);

/// A line per policy, parameter and operator, and below who is dominated; for people to read.
std::string TradeoffTable(const TradeoffSweep& sweep, const std::vector<TradeoffRow>& rows);

/// {experiment, operators: "simulated", ..., points: [...], policies: [...]}. An infinite
/// difference is null.
nlohmann::ordered_json TradeoffJson(const TradeoffSweep& sweep,
                                    const std::vector<TradeoffRow>& rows);

/// A line per episode, with a header.
std::string TradeoffCsv(const TradeoffSweep& sweep, const std::vector<ExperimentEpisode>& episodes);

/// An SVG document: a panel per kind of operator, pictures to the right (square-root scale, as most
/// policies differ where they are few), moves upwards, a line per policy through its points in the
/// order of their parameter, with both intervals of each.
std::string TradeoffPlot(const TradeoffSweep& sweep, const std::vector<TradeoffRow>& rows);

}  // namespace conav::planner
