#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "planner/experiment/tradeoff_analysis.h"

namespace conav::planner {

/// A line per policy, parameter and operator, and below who is dominated; for people to read.
std::string TradeoffTable(const TradeoffSweep& sweep, const std::vector<TradeoffRow>& rows);

/// {experiment, operators: "simulated", ..., points: [...], policies: [...]}. An infinite
/// difference is null.
nlohmann::ordered_json TradeoffJson(const TradeoffSweep& sweep,
                                    const std::vector<TradeoffRow>& rows);

/// A line per episode, with a header.
std::string TradeoffCsv(const TradeoffSweep& sweep, const std::vector<ExperimentEpisode>& episodes);

}  // namespace conav::planner
