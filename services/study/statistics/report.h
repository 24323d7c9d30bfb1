#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "common/plot/svg.h"
#include "study/statistics/analysis.h"

namespace conav::statistics {

/// A table as it is shown, whatever by: the first column holds names, the others figures.
struct ReportSection {
  std::string title;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> remarks;  // lines below
};

/// "ergoStool.csv: 9 subjects, 4 conditions".
std::string DescribeTable(const Analysis& analysis);

std::vector<ReportSection> ReportSections(const Analysis& analysis);

/// For a terminal, an empty line before.
std::string SectionText(const ReportSection& section);

/// Title and table for a page that begins with PageHead().
std::string SectionHtml(const ReportSection& section);

/// The begin of a page, up to its first heading, with the style sheet of tables and plots.
std::string PageHead(const std::string& title);

/// What the values of a plot are.
struct PlotAxis {
  std::string label;  // with the unit
  AxisLimits limits;  // intervals that reach beyond are cut there
};

/// ConditionsPlot with its legend.
std::string PlotFigure(const Analysis& analysis, const PlotAxis& values = {});

/// All tables for a terminal.
std::string ReportText(const Analysis& analysis);

/// Every figure at full precision, names as in docs/statistics.md. What is infinite or does not
/// exist is null; `notes` says why.
nlohmann::ordered_json ReportJson(const Analysis& analysis);

/// One page for a browser, without any other file: the same tables as the text, and a plot.
std::string ReportPage(const Analysis& analysis);

}  // namespace conav::statistics
