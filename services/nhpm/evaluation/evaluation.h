#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/msg/perception_model.h"
#include "common/segments/segment.h"
#include "nhpm/evaluation/metrics.h"
#include "nhpm/model/glpf.h"

namespace conav::nhpm {

struct NelderMeadOptions {
  int iterations = 2000;    // at most
  double first_step = 0.5;  // of each coordinate
  /// Stops when the values at the corners differ by less than this, and each coordinate of the
  /// corners from the best one's by less than its square root: near a minimum values differ by the
  /// square.
  double tolerance = 1.0e-10;
};

struct NelderMeadResult {
  std::vector<double> position;
  double value = 0.0;
  int iterations = 0;
  bool converged = false;
};

/// Minimises `function` from `start` without derivatives, by the downhill simplex: reflection,
/// expansion, contraction, shrinking (J. A. Nelder, R. Mead, Computer Journal 7, 1965). Finds a
/// local minimum; NaN counts as infinite. Deterministic. Not NLopt's, whose steps and stops differ:
/// with it the last digits of table 1 would change.
/// Requires at least one coordinate.
NelderMeadResult MinimiseNelderMead(const std::function<double(std::span<const double>)>& function,
                                    std::span<const double> start,
                                    const NelderMeadOptions& options = {});

/// Cells to which a GLPF always gives the same probability, whatever its parameters.
struct StimulusCount {
  double outputs = 0.0;
  double edits = 0.0;
};

/// The sufficient statistics of a GLPF's loss on a set of segments: how many cells have which
/// stimulus, and how many of them were edited. So a fit costs the same for any number of segments.
struct GlpfStatistics {
  /// By squared distance to the camera in cells: wrong on the map, according to the picture.
  std::map<int, StimulusCount> seen;
  /// Walls of the map on the path that the picture does not show: a stimulus unless visible_only.
  std::map<int, StimulusCount> on_path;
  StimulusCount unstimulated;

  double outputs() const;
};

/// Counts the unmasked outputs. The segments passed CheckSegment.
GlpfStatistics CountStimuli(std::span<const Segment* const> segments);

/// `factor` times the counts of `a`, and those of `b`.
GlpfStatistics WeightedSum(const GlpfStatistics& a, double factor, const GlpfStatistics& b);

/// Mean cross-entropy of the GLPF over the unmasked outputs, in nats; 0 for none. Equals
/// MeanCrossEntropy(...).unmasked of its answers, except for their rounding to float.
double GlpfLoss(const GlpfStatistics& statistics, const GlpfParameters& parameters);

/// One form of the GLPF, with its best parameters.
struct GlpfVariant {
  GlpfParameters parameters;
  double loss = 0.0;  // GlpfLoss
};

struct GlpfFit {
  GlpfVariant best;
  std::vector<GlpfVariant> variants;  // with the path as a stimulus, and without
};

/// The GLPF's parameters of least cross-entropy: Nelder-Mead from a grid of starts, then once more
/// from the best. alpha_d and alpha_m in (0, 10], beta in (0, 1000], rho and lambda in [0, 0.5].
/// Deterministic; on equal losses the first variant wins. The paper prints one letter alpha for decay
/// and midpoint; two include the case of one, so that the baseline is the strongest that the formula
/// allows.
/// Source: paper section 6.1 (GLPF-Train, GLPF-Test).
GlpfFit FitGlpf(const GlpfStatistics& statistics);

}  // namespace conav::nhpm

/// Table 1 of the paper: models of how people edit their map, one row each.
namespace conav::nhpm {

/// The data of a comparison.
struct EvaluationData {
  SegmentSet train;  // training and validation data of the models; may be empty
  SegmentSet test;   // of trajectories that no model learned from
  std::string file;
  std::string checksum;  // SHA-256 of the file
  /// Empty = not split: the whole file is the test part.
  std::optional<std::uint64_t> split_seed;
};

/// Reads the segments and splits them as `conav train` does; without a seed all are the test part.
/// Errors: those of ReadSegmentFile; kInvalidArgument if no segments are left for the test.
[[nodiscard]] Result<EvaluationData> LoadEvaluationData(const std::filesystem::path& file,
                                                        std::optional<std::uint64_t> split_seed);

/// Which part the ideal boundary comes from.
enum class BoundarySource : std::uint8_t { kTrain, kTest };

/// All figures of one model on the test part.
struct ModelMetrics {
  Loss loss;
  BoundaryIou best;  // the IoU is always that of the test part
  BoundarySource boundary_source = BoundarySource::kTest;
  double iou_fixed = 0.0;                   // at kFixedBoundary
  std::optional<double> segment_iou_best;   // mean of segments, at best.boundary
  std::optional<double> segment_iou_fixed;  // ... at kFixedBoundary
  Calibration calibration;
  EditCounts edits;
};

/// The boundary is ideal on these outcomes.
ModelMetrics Measure(const Outcomes& outcomes);

/// The labels of a model in the report.
struct RowLabel {
  std::string key;    // in JSON: "nhpm", "glpf_train", ...
  std::string title;  // for people: "GLPF-Train"
  std::string about;  // parameters, file, origin of the model
};

/// One row of table 1.
struct ModelRow {
  RowLabel label;
  ModelIdentity identity;
  ModelMetrics test;
  std::optional<Loss> train;  // empty if not applicable
  /// The boundary that is ideal on the train part, and the IoU of the test part at that boundary.
  std::optional<BoundaryIou> at_train_boundary;
  /// Cross-entropy of each test segment, summed over its outputs, in nats.
  std::vector<double> segment_losses;
  std::vector<PerceptionAnswer> answers;  // to the test segments
};

/// Called now and then with the number of answered segments.
using EvaluationProgress = std::function<void(std::size_t done, std::size_t total)>;

/// Gets the answers of `model` to all segments, in batches.
/// Errors: those of Predict.
[[nodiscard]] Result<std::vector<PerceptionAnswer>> AskModel(PerceptionModel& model,
                                                             const SegmentSet& segments,
                                                             const EvaluationProgress& progress);

/// The row of a model that answers both parts of the data; the boundary is ideal on the test part.
/// Errors: those of Predict and PairOutcomes.
[[nodiscard]] Result<ModelRow> EvaluateModel(const RowLabel& label, PerceptionModel& model,
                                             const EvaluationData& data,
                                             const EvaluationProgress& progress = {});

/// The row for given answers to the test part (the oracle's).
/// Errors: those of PairOutcomes, with the row's title.
[[nodiscard]] Result<ModelRow> EvaluateAnswers(const RowLabel& label, const ModelIdentity& identity,
                                               std::vector<PerceptionAnswer> answers,
                                               const EvaluationData& data);

/// GLPF-Train: fitted to the train part, with the boundary ideal there. Requires a train part.
/// Errors: those of EvaluateModel.
[[nodiscard]] Result<ModelRow> EvaluateGlpfTrain(const EvaluationData& data);

/// GLPF-Test: fitted to the test part itself, with the boundary ideal there; an upper bound of the
/// formula. Leaves out the train part, as in the paper.
/// Errors: those of EvaluateModel.
[[nodiscard]] Result<ModelRow> EvaluateGlpfTest(const EvaluationData& data);

/// The range of a figure over other test sets of the same size.
struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// A limit that a figure must meet.
struct Bar {
  std::string key;   // in JSON
  std::string text;  // what is measured, for people
  double value = 0.0;
  double limit = 0.0;
  bool at_most = true;  // otherwise it must be above the limit
  std::optional<Interval> interval;

  bool passed() const { return at_most ? value <= limit : value > limit; }
};

/// Limit on NHPM's loss above the oracle, as a share of GLPF-Test's loss above the oracle.
inline constexpr double kLargestExcessShare = 0.20;

/// The loss of `model` above that of `oracle`, as a share of the same for `baseline`; infinite if
/// the baseline is no worse than the oracle. 0 = as good as the oracle, 1 = as the baseline.
double ExcessShare(double model, double oracle, double baseline);

/// The 90 % interval of the excess share when trajectories are resampled with replacement
/// (percentile bootstrap, 2000 draws, seeded). Empty for fewer than two trajectories.
std::optional<Interval> ExcessShareInterval(const EvaluationData& data, const ModelRow& model,
                                            const ModelRow& oracle, const ModelRow& baseline);

/// Whether the test part has bars: synthetic people only.
bool HasBars(const EvaluationData& data);

/// The bars of NHPM (the row of key "nhpm") that the rows allow: the share of the loss needs the
/// oracle, the IoU a GLPF. Empty without NHPM, and for data without bars.
std::vector<Bar> CheckBars(const EvaluationData& data, const std::vector<ModelRow>& rows);

/// The row with that key, or nullptr.
const ModelRow* FindRow(const std::vector<ModelRow>& rows, const std::string& key);

}  // namespace conav::nhpm
