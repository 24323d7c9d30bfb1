#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "study/experiment/tradeoff.h"

namespace conav::planner {

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
