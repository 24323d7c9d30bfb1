#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/msg/perception_model.h"
#include "common/segments/segment.h"
#include "nhpm/evaluation/glpf_fit.h"
#include "nhpm/evaluation/metrics.h"

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
[[nodiscard]] Result<ModelRow> EvaluateGlpfTrain(const EvaluationData& data,
                                                 const GlpfFitOptions& options = {});

/// GLPF-Test: fitted to the test part itself, with the boundary ideal there; an upper bound of the
/// formula. Leaves out the train part, as in the paper.
/// Errors: those of EvaluateModel.
[[nodiscard]] Result<ModelRow> EvaluateGlpfTest(const EvaluationData& data,
                                                const GlpfFitOptions& options = {});

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
