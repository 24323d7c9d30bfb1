#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "nhpm/evaluation/evaluation.h"
#include "nhpm/evaluation/report_figure.h"

namespace conav::nhpm {

/// The content of a report. Every view of synthetic data says "synthetic".
struct EvaluationReport {
  EvaluationData data;
  std::vector<ModelRow> rows;  // in the order of the table
  std::vector<Bar> bars;
  std::vector<FigureSegment> figures;
};

/// One line about the test data: "synthetic data.pb.zst: 6 trajectories, 85 segments ..., unseen".
std::string DescribeData(const EvaluationData& data);

/// "pass" or "FAIL", the measure, the figure and its limit.
std::string DescribeBar(const Bar& bar);

/// Table 1 and the bars for a terminal.
std::string ReportTable(const EvaluationReport& report);

/// A header and one line per model. RFC 4180: fields with commas or quotes are quoted.
std::string ReportCsv(const EvaluationReport& report);

/// One self-contained page for a browser: table 1, bars, reliability diagrams, expected against
/// true edits, and the paper's figure 3 for the chosen segments.
std::string ReportPage(const EvaluationReport& report);

/// The report for machines:
///
///   schema    1
///   data      file, sha256, origin, split_seed (null: all is test), rows, columns
///             (null: maps of several sizes),
///             train and test: {trajectories, segments, edits}
///   models    by key (nhpm, glpf_train, glpf_test, oracle, ...): title, about, version, checksum,
///             mbce_all, mbce_unmasked, train_mbce_all, train_mbce_unmasked, iou_best,
///             iou_best_boundary, iou_best_boundary_from, iou_fixed, iou_fixed_boundary,
///             segment_iou_best, segment_iou_fixed, ece, reliability [...],
///             expected_edits_mean, true_edits_mean, edits_correlation, edits_bins [...]
///   bars      by key: value, limit, at_most, passed, low, high
///   figures   [{segment, reason}]
///
/// A figure that does not apply is null; an infinite one too.
nlohmann::ordered_json ReportJson(const EvaluationReport& report);

}  // namespace conav::nhpm
