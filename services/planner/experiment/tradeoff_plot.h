#pragma once

#include <string>
#include <vector>

#include "planner/experiment/tradeoff_analysis.h"

namespace conav::planner {

/// An SVG document: a panel per kind of operator, pictures to the right (square-root scale, as most
/// policies differ where they are few), moves upwards, a line per policy through its points in the
/// order of their parameter, with both intervals of each.
std::string TradeoffPlot(const TradeoffSweep& sweep, const std::vector<TradeoffRow>& rows);

}  // namespace conav::planner
