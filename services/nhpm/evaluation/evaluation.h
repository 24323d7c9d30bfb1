#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/segments/segment.h"
#include "nhpm/evaluation/glpf_fit.h"
#include "nhpm/evaluation/metrics.h"
#include "nhpm/model/edit_model.h"

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
[[nodiscard]] Result<std::vector<PerceptionAnswer>> AskModel(const EditModel& model,
                                                             const SegmentSet& segments,
                                                             const EvaluationProgress& progress);

/// The row of a model, asked about both parts of the data; boundary ideal on the test part.
/// Errors: those of Predict and PairOutcomes.
[[nodiscard]] Result<ModelRow> EvaluateModel(const RowLabel& label, const EditModel& model,
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

}  // namespace conav::nhpm
