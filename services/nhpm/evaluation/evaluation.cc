#include "nhpm/evaluation/evaluation.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>

#include "common/runtime/random.h"
#include "common/runtime/result.h"
#include "common/segments/segment_file.h"
#include "common/segments/segment_split.h"

namespace conav::nhpm {
namespace {

constexpr std::size_t kBatch = 64;

Result<Outcomes> Pair(const SegmentSet& segments, std::span<const PerceptionAnswer> answers) {
  return PairOutcomes(AllSegments(segments), answers);
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

/// The model's answers to the train part, paired with the edits.
Result<Outcomes> OnTrain(PerceptionModel& model, const EvaluationData& data) {
  return AskModel(model, data.train, {})
      .and_then(
          [&](const std::vector<PerceptionAnswer>& answers) { return Pair(data.train, answers); });
}

constexpr int kBootstrapDraws = 2000;

/// Sums of the three losses over a trajectory.
struct TrajectoryLosses {
  double model = 0.0;
  double oracle = 0.0;
  double baseline = 0.0;
};

std::vector<TrajectoryLosses> ByTrajectory(const EvaluationData& data, const ModelRow& model,
                                           const ModelRow& oracle, const ModelRow& baseline) {
  std::vector<TrajectoryLosses> losses;
  std::size_t segment = 0;
  for (const Trajectory& trajectory : data.test.trajectories) {
    TrajectoryLosses& sum = losses.emplace_back();
    for (std::size_t i = 0; i < trajectory.segments.size(); ++i, ++segment) {
      sum.model += model.segment_losses[segment];
      sum.oracle += oracle.segment_losses[segment];
      sum.baseline += baseline.segment_losses[segment];
    }
  }
  return losses;
}

double DrawnShare(const std::vector<TrajectoryLosses>& losses, Random& random) {
  TrajectoryLosses sum;
  for (std::size_t i = 0; i < losses.size(); ++i) {
    const auto last = static_cast<std::int64_t>(losses.size()) - 1;
    const TrajectoryLosses& drawn = losses[static_cast<std::size_t>(random.Uniform(0, last))];
    sum.model += drawn.model;
    sum.oracle += drawn.oracle;
    sum.baseline += drawn.baseline;
  }
  return ExcessShare(sum.model, sum.oracle, sum.baseline);
}

/// Compares at the boundaries from the same part as the baseline's.
Bar IouBar(const ModelRow& model, const ModelRow& baseline) {
  const bool of_train = baseline.test.boundary_source == BoundarySource::kTrain;
  const BoundaryIou& best = of_train ? model.at_train_boundary.value() : model.test.best;
  return {.key = "iou_above_" + baseline.label.key,
          .text = fmt::format("{}'s IoU, above {}'s, each at the boundary that is best on the {}",
                              model.label.title, baseline.label.title,
                              of_train ? "train part" : "test part"),
          .value = best.iou,
          .limit = baseline.test.best.iou,
          .at_most = false};
}

}  // namespace

Result<EvaluationData> LoadEvaluationData(const std::filesystem::path& file,
                                          std::optional<std::uint64_t> split_seed) {
  auto read = ReadIdentifiedSegments(file);
  if (!read) return tl::unexpected(read.error());
  EvaluationData data;
  data.file = file.filename().string();
  data.checksum = read->checksum;
  data.split_seed = split_seed;
  if (!split_seed) {
    data.test = std::move(read->set);
  } else {
    SegmentSplit split = SplitSegments(read->set, *split_seed);
    data.train = std::move(split.train);
    std::ranges::move(split.validation.trajectories, std::back_inserter(data.train.trajectories));
    data.test = std::move(split.test);
  }
  if (SegmentCount(data.test) > 0) return data;
  const std::size_t trajectories = data.train.trajectories.size();
  return Fail(
      ErrorCode::kInvalidArgument,
      fmt::format("{}: nothing is left for the test of its {} {}; --all-test takes the whole file",
                  file.string(), trajectories, trajectories == 1 ? "trajectory" : "trajectories"));
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

Result<std::vector<PerceptionAnswer>> AskModel(PerceptionModel& model, const SegmentSet& segments,
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

Result<ModelRow> EvaluateModel(const RowLabel& label, PerceptionModel& model,
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

Result<ModelRow> EvaluateGlpfTrain(const EvaluationData& data) {
  DEMAND(!data.train.trajectories.empty());
  const GlpfFit fit = FitGlpf(CountStimuli(AllSegments(data.train)));
  Glpf model(fit.best.parameters);
  auto row = EvaluateModel({"glpf_train", "GLPF-Train", Describe(fit.best)}, model, data);
  if (!row) return row;
  row->test.best = *row->at_train_boundary;
  row->test.segment_iou_best =
      SegmentMeanIou(*Pair(data.test, row->answers), row->test.best.boundary);
  row->test.boundary_source = BoundarySource::kTrain;
  return row;
}

Result<ModelRow> EvaluateGlpfTest(const EvaluationData& data) {
  const GlpfFit fit = FitGlpf(CountStimuli(AllSegments(data.test)));
  Glpf model(fit.best.parameters);
  return AskModel(model, data.test, {}).and_then([&](const std::vector<PerceptionAnswer>& answers) {
    return EvaluateAnswers({"glpf_test", "GLPF-Test", Describe(fit.best)}, model.identity(),
                           answers, data);
  });
}

double ExcessShare(double model, double oracle, double baseline) {
  if (!(baseline > oracle)) return std::numeric_limits<double>::infinity();
  return (model - oracle) / (baseline - oracle);
}

std::optional<Interval> ExcessShareInterval(const EvaluationData& data, const ModelRow& model,
                                            const ModelRow& oracle, const ModelRow& baseline) {
  const std::vector<TrajectoryLosses> losses = ByTrajectory(data, model, oracle, baseline);
  if (losses.size() < 2) return {};
  Random random(1);
  std::vector<double> shares;
  for (int i = 0; i < kBootstrapDraws; ++i) shares.push_back(DrawnShare(losses, random));
  std::sort(shares.begin(), shares.end());
  return Interval{shares[kBootstrapDraws / 20], shares[kBootstrapDraws - 1 - kBootstrapDraws / 20]};
}

bool HasBars(const EvaluationData& data) { return OriginText(data.test) == "synthetic"; }

std::vector<Bar> CheckBars(const EvaluationData& data, const std::vector<ModelRow>& rows) {
  std::vector<Bar> bars;
  const ModelRow* nhpm = FindRow(rows, "nhpm");
  const ModelRow* oracle = FindRow(rows, "oracle");
  const ModelRow* glpf_test = FindRow(rows, "glpf_test");
  if (nhpm == nullptr || !HasBars(data)) return bars;
  if (oracle != nullptr && glpf_test != nullptr) {
    bars.push_back(
        {.key = "excess_share",
         .text = "NHPM's loss above the oracle, as a share of GLPF-Test's",
         .value = ExcessShare(nhpm->test.loss.all, oracle->test.loss.all, glpf_test->test.loss.all),
         .limit = kLargestExcessShare,
         .interval = ExcessShareInterval(data, *nhpm, *oracle, *glpf_test)});
  }
  for (const char* key : {"glpf_train", "glpf_test"}) {
    const ModelRow* glpf = FindRow(rows, key);
    if (glpf != nullptr) bars.push_back(IouBar(*nhpm, *glpf));
  }
  return bars;
}

const ModelRow* FindRow(const std::vector<ModelRow>& rows, const std::string& key) {
  for (const ModelRow& row : rows) {
    if (row.label.key == key) return &row;
  }
  return nullptr;
}

}  // namespace conav::nhpm
