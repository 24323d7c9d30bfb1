#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "common/plot/svg.h"
#include "study/statistics/analysis.h"

namespace conav::statistics {

/// A table for any output: the first column holds names, the others figures.
struct ReportSection {
  std::string title;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> remarks;  // lines below
};

/// "ergoStool.csv: 9 subjects, 4 conditions".
std::string DescribeTable(const Analysis& analysis);

std::vector<ReportSection> ReportSections(const Analysis& analysis);

/// For a terminal, with an empty line before it.
std::string SectionText(const ReportSection& section);

/// Title and table for a page that begins with PageHead().
std::string SectionHtml(const ReportSection& section);

/// The beginning of a page, up to its first heading, with the style sheet of tables and plots.
std::string PageHead(const std::string& title);

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
