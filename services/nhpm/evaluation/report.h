#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "nhpm/evaluation/evaluation.h"

namespace conav::nhpm {

/// A test segment for the page, and the reason for the choice.
struct FigureSegment {
  std::size_t index = 0;  // among all test segments, from 0
  std::string reason;
};

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

/// [{low, high, outputs, mean_probability, edited_share}]
nlohmann::ordered_json ReliabilityJson(const Calibration& calibration);

/// The beginning of a page, up to its title as a heading.
std::string PageHead(const std::string& title);

/// Share of edited outputs over the predicted probability: a dot per non-empty bin, larger for more
/// outputs. The diagonal is perfect.
std::string ReliabilityPlot(const std::string& title, const Calibration& calibration);

// The paper's figure 3 (report_figure.cc): chooses its segments and draws its panels, as SVG elements
// with the classes of the page's style sheet.

/// The person put a wall that is up to 3 cells away in the picture one cell farther or nearer along
/// the line of sight. Paper figure 3, first case.
bool ShowsMisplacedNearWall(const Segment& segment);

/// The person added a missing wall 3 cells away or more, within 12 degrees of the view axis, but
/// not a nearer one more than 25 degrees to the side. Paper figure 3, second case.
bool ShowsPreferredFarWall(const Segment& segment);

/// Up to `count` segments for the page's figure: one third of each of the paper's two cases, where
/// the two models differ most among them, then those where they differ most of all. The difference
/// is the sum over all cells of |P - P'|.
std::vector<FigureSegment> ChooseFigureSegments(const EvaluationData& data, const ModelRow& first,
                                                const ModelRow& second, std::size_t count = 6);

/// Sum over all cells of the difference between two answers, in edits.
double Difference(const PerceptionAnswer& a, const PerceptionAnswer& b);

/// The operator's map before the picture.
std::string BeforePanel(const Segment& segment);

/// The path since the last picture, the cells in the picture, and the camera.
std::string ViewPanel(const Segment& segment);

/// The probabilities of a model on the map: the stronger the colour the likelier the edit, in
/// percent from 5 % on.
std::string PredictionPanel(const Segment& segment, const PerceptionAnswer& answer,
                            const std::string& title);

/// The person's edits: + for an added wall, a minus sign for a removed one.
std::string TruthPanel(const Segment& segment);

}  // namespace conav::nhpm
