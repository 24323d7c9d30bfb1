#include "nhpm/evaluation/evaluation.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/runtime/demand.h"
#include "common/segments/segment_labels.h"

namespace conav::nhpm {
namespace {

constexpr std::size_t kBatch = 64;

Result<Outcomes> Pair(const SegmentSet& segments, std::span<const PerceptionAnswer> answers) {
  return PairOutcomes(AllSegments(segments), answers);
}

ModelMetrics Measure(const Outcomes& outcomes) {
  ModelMetrics metrics;
  metrics.loss = MeanCrossEntropy(outcomes);
  metrics.best = BestIou(outcomes);
  metrics.iou_fixed = IouAt(outcomes, kFixedBoundary);
  metrics.segment_iou_best = SegmentMeanIou(outcomes, metrics.best.boundary);
  metrics.segment_iou_fixed = SegmentMeanIou(outcomes, kFixedBoundary);
  metrics.calibration = Calibrate(outcomes);
  metrics.edits = CompareEditCounts(outcomes);
  return metrics;
}

std::vector<double> SegmentLosses(const Outcomes& outcomes) {
  std::vector<double> losses(outcomes.segments(), 0.0);
  for (std::size_t i = 0; i < losses.size(); ++i) {
    for (const Outcome& outcome : outcomes.Segment(i)) {
      losses[i] += CrossEntropy(static_cast<double>(outcome.probability), outcome.edited);
    }
  }
  return losses;
}

std::string Describe(const GlpfVariant& variant) {
  const GlpfParameters& p = variant.parameters;
  return fmt::format("alpha_d {:.4g}, alpha_m {:.4g}, beta {:.4g}, rho {:.4g}, lambda {:.4g}, {}",
                     p.alpha_d, p.alpha_m, p.beta, p.rho, p.lambda,
                     p.visible_only ? "the picture only" : "picture and path");
}

/// The model's answers to the train part, paired with what people did.
Result<Outcomes> OnTrain(const EditModel& model, const EvaluationData& data) {
  return AskModel(model, data.train, {})
      .and_then(
          [&](const std::vector<PerceptionAnswer>& answers) { return Pair(data.train, answers); });
}

}  // namespace

Result<std::vector<PerceptionAnswer>> AskModel(const EditModel& model, const SegmentSet& segments,
                                               const EvaluationProgress& progress) {
  const std::vector<PerceptionQuery> queries = Queries(segments);
  std::vector<PerceptionAnswer> answers;
  answers.reserve(queries.size());
  while (answers.size() < queries.size()) {
    const std::size_t count = std::min(kBatch, queries.size() - answers.size());
    auto batch = model.Predict(std::span(queries).subspan(answers.size(), count));
    if (!batch) return batch;
    std::move(batch->begin(), batch->end(), std::back_inserter(answers));
    if (progress) progress(answers.size(), queries.size());
  }
  return answers;
}

Result<ModelRow> EvaluateAnswers(const RowLabel& label, const ModelIdentity& identity,
                                 std::vector<PerceptionAnswer> answers,
                                 const EvaluationData& data) {
  const auto outcomes = Pair(data.test, answers);
  if (!outcomes) {
    return Fail(outcomes.error().code, fmt::format("{}: {}", label.title, outcomes.error().text));
  }
  return ModelRow{.label = label,
                  .identity = identity,
                  .test = Measure(*outcomes),
                  .segment_losses = SegmentLosses(*outcomes),
                  .answers = std::move(answers)};
}

Result<ModelRow> EvaluateModel(const RowLabel& label, const EditModel& model,
                               const EvaluationData& data, const EvaluationProgress& progress) {
  auto answers = AskModel(model, data.test, progress);
  if (!answers) return tl::unexpected(answers.error());
  auto row = EvaluateAnswers(label, model.identity(), std::move(*answers), data);
  if (!row || data.train.trajectories.empty()) return row;
  const auto train = OnTrain(model, data);
  if (!train) return tl::unexpected(train.error());
  row->train = MeanCrossEntropy(*train);
  const double boundary = BestIou(*train).boundary;
  row->at_train_boundary = {boundary, IouAt(*Pair(data.test, row->answers), boundary)};
  return row;
}

Result<ModelRow> EvaluateGlpfTrain(const EvaluationData& data, const GlpfFitOptions& options) {
  DEMAND(!data.train.trajectories.empty());
  const GlpfFit fit = FitGlpf(CountStimuli(AllSegments(data.train)), options);
  const Glpf model(fit.best.parameters);
  auto row = EvaluateModel({"glpf_train", "GLPF-Train", Describe(fit.best)}, model, data);
  if (!row) return row;
  row->test.best = *row->at_train_boundary;
  row->test.segment_iou_best =
      SegmentMeanIou(*Pair(data.test, row->answers), row->test.best.boundary);
  row->test.boundary_source = BoundarySource::kTrain;
  return row;
}

Result<ModelRow> EvaluateGlpfTest(const EvaluationData& data, const GlpfFitOptions& options) {
  const GlpfFit fit = FitGlpf(CountStimuli(AllSegments(data.test)), options);
  const Glpf model(fit.best.parameters);
  return AskModel(model, data.test, {}).and_then([&](const std::vector<PerceptionAnswer>& answers) {
    return EvaluateAnswers({"glpf_test", "GLPF-Test", Describe(fit.best)}, model.identity(),
                           answers, data);
  });
}

}  // namespace conav::nhpm
