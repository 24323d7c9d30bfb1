#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "common/plot/axes.h"
#include "study/report_page.h"
#include "study/statistics/analysis.h"

namespace conav::statistics {

std::vector<study::ReportSection> ReportSections(const Analysis& analysis);

/// One of several analyses of the same subjects.
struct NamedAnalysis {
  std::string name;
  const Analysis* analysis = nullptr;
};

/// A row per analysis: F, Greenhouse and Geisser's p, Friedman's test.
study::ReportSection VarianceOverview(std::span<const NamedAnalysis> analyses);
/// A row per pair of each analysis: paired t, Holm's p over the pairs of the analysis, d_z.
study::ReportSection PairOverview(std::span<const NamedAnalysis> analyses);

/// The pairs that were tested for equivalence.
study::ReportSection EquivalenceSection(const Analysis& analysis);
nlohmann::ordered_json EquivalenceJson(const Equivalence& equivalence);

/// The value axis of a plot.
struct PlotAxis {
  std::string label;  // with the unit
  AxisLimits limits;  // intervals beyond them are cut
};

/// ConditionsPlot with its legend.
std::string PlotFigure(const Analysis& analysis, const PlotAxis& values = {});

/// All tables for a terminal.
std::string ReportText(const Analysis& analysis);

/// Every figure at full precision, names as in docs/statistics.md. Infinite and missing values are
/// null; `notes` gives the reason.
nlohmann::ordered_json ReportJson(const Analysis& analysis);

/// One self-contained page for a browser: the tables of the text, and a plot.
std::string ReportPage(const Analysis& analysis);

/// With more lines a plot is unreadable.
inline constexpr std::size_t kMostLines = 200;

/// A line per subject (the first kMostLines) over the conditions, each condition's mean with its
/// interval (thin) and its within-subject interval (thick), as an SVG element with the classes of
/// the page's style sheet.
std::string ConditionsPlot(const Analysis& analysis, const PlotAxis& values = {});

}  // namespace conav::statistics
