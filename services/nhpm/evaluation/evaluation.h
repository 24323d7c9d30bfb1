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

/// What the models are compared on.
struct EvaluationData {
  SegmentSet train;  // what models may have learned from, with the validation part; may be empty
  SegmentSet test;   // of trajectories that they never saw
  std::string file;
  std::string checksum;  // SHA-256 of the file
  /// Nothing = not split, all of the file is test.
  std::optional<std::uint64_t> split_seed;
};

/// Where a model's ideal boundary was searched.
enum class BoundarySource : std::uint8_t { kTrain, kTest };

/// All figures of one model on the test part.
struct ModelMetrics {
  Loss loss;
  BoundaryIou best;  // the IoU is that of the test part, wherever the boundary comes from
  BoundarySource boundary_source = BoundarySource::kTest;
  double iou_fixed = 0.0;                   // at kFixedBoundary
  std::optional<double> segment_iou_best;   // mean of segments, at best.boundary
  std::optional<double> segment_iou_fixed;  // ... at kFixedBoundary
  Calibration calibration;
  EditCounts edits;
};

/// What is said about a model in the report.
struct RowLabel {
  std::string key;    // in JSON: "nhpm", "glpf_train", ...
  std::string title;  // for people: "GLPF-Train"
  std::string about;  // parameters, file, where the model comes from
};

/// One row of table 1.
struct ModelRow {
  RowLabel label;
  ModelIdentity identity;
  ModelMetrics test;
  std::optional<Loss> train;  // nothing where it does not apply
  /// The boundary that is ideal on the train part, and the IoU of the test part there.
  std::optional<BoundaryIou> at_train_boundary;
  /// Cross-entropy of each test segment, summed over its outputs, in nats.
  std::vector<double> segment_losses;
  std::vector<PerceptionAnswer> answers;  // to the test segments
};

/// Called now and then with how many of all segments are answered.
using EvaluationProgress = std::function<void(std::size_t done, std::size_t total)>;

/// Asks `model` about all segments, in batches.
/// Errors: those of Predict.
[[nodiscard]] Result<std::vector<PerceptionAnswer>> AskModel(PerceptionModel& model,
                                                             const SegmentSet& segments,
                                                             const EvaluationProgress& progress);

/// The row of a model, asked about both parts of the data; boundary ideal on the test part.
/// Errors: those of Predict and PairOutcomes.
[[nodiscard]] Result<ModelRow> EvaluateModel(const RowLabel& label, PerceptionModel& model,
                                             const EvaluationData& data,
                                             const EvaluationProgress& progress = {});

/// The row of answers to the test part that come from elsewhere (the oracle's).
/// Errors: those of PairOutcomes, with the row's title.
[[nodiscard]] Result<ModelRow> EvaluateAnswers(const RowLabel& label, const ModelIdentity& identity,
                                               std::vector<PerceptionAnswer> answers,
                                               const EvaluationData& data);

/// GLPF-Train: fitted to the train part, its boundary ideal there. Requires a train part.
/// Errors: those of EvaluateModel.
[[nodiscard]] Result<ModelRow> EvaluateGlpfTrain(const EvaluationData& data,
                                                 const GlpfFitOptions& options = {});

/// GLPF-Test: fitted to the test part itself, with the boundary ideal there; an upper bound of what
/// the formula can do. Says nothing about the train part, as in the paper.
/// Errors: those of EvaluateModel.
[[nodiscard]] Result<ModelRow> EvaluateGlpfTest(const EvaluationData& data,
                                                const GlpfFitOptions& options = {});

/// A range of figures that other test sets of the same size may give.
struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// A figure that must be reached.
struct Bar {
  std::string key;   // in JSON
  std::string text;  // what is measured, for people
  double value = 0.0;
  double limit = 0.0;
  bool at_most = true;  // otherwise: more than the limit
  std::optional<Interval> interval;

  bool passed() const { return at_most ? value <= limit : value > limit; }
};

/// NHPM's loss above the oracle may be this share of GLPF-Test's loss above the oracle.
inline constexpr double kLargestExcessShare = 0.20;

/// The loss of `model` above that of `oracle`, as a share of what `baseline` has above it; infinite
/// where the baseline is no worse than the oracle. 0 = as good as the oracle, 1 = as the baseline.
double ExcessShare(double model, double oracle, double baseline);

/// 90 % of the excess shares when the trajectories are drawn again with replacement (percentile
/// bootstrap, 2000 draws, seeded). Nothing for fewer than two trajectories.
std::optional<Interval> ExcessShareInterval(const EvaluationData& data, const ModelRow& model,
                                            const ModelRow& oracle, const ModelRow& baseline);

/// Whether bars were set for the test part: synthetic people only.
bool HasBars(const EvaluationData& data);

/// What NHPM (the row of key "nhpm") must reach, of what the rows allow to say: the share of the
/// loss needs the oracle, the IoU a GLPF. Empty without NHPM, and where there are no bars.
std::vector<Bar> CheckBars(const EvaluationData& data, const std::vector<ModelRow>& rows);

/// The row of that key, or nullptr.
const ModelRow* FindRow(const std::vector<ModelRow>& rows, const std::string& key);

}  // namespace conav::nhpm
