#pragma once

#include <string>

#include "study/statistics/analysis.h"
#include "study/statistics/report.h"

namespace conav::statistics {

/// With more lines a plot is unreadable.
inline constexpr std::size_t kMostLines = 200;

/// A line per subject (the first kMostLines) over the conditions, each condition's mean with its
/// interval (thin) and its within-subject interval (thick), as an SVG element with the classes of
/// the page's style sheet.
std::string ConditionsPlot(const Analysis& analysis, const PlotAxis& values = {});

}  // namespace conav::statistics
