#pragma once

#include <string>
#include <vector>

#include "nhpm/evaluation/bars.h"
#include "nhpm/evaluation/figure_segments.h"

namespace conav::nhpm {

/// All that is shown of an evaluation. "synthetic" is said wherever the data is.
struct EvaluationReport {
  EvaluationData data;
  std::vector<ModelRow> rows;  // in the order of the table
  std::vector<Bar> bars;
  std::vector<FigureSegment> figures;
};

/// "synthetic data.pb.zst: 6 trajectories, 85 segments ..., unseen": what was tested on, in one line.
std::string DescribeData(const EvaluationData& data);

/// "pass" or "FAIL", what was measured, the figure and its limit.
std::string DescribeBar(const Bar& bar);

/// Table 1 and the bars for a terminal.
std::string ReportTable(const EvaluationReport& report);

/// A header and one line per model. RFC 4180: fields with commas or quotes are quoted.
std::string ReportCsv(const EvaluationReport& report);

/// One page for a browser, without any other file: table 1, bars, reliability diagrams, expected
/// against true edits, and the paper's figure 3 for the chosen segments.
std::string ReportPage(const EvaluationReport& report);

}  // namespace conav::nhpm
