#include "nhpm/evaluation/bars.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "common/runtime/random.h"
#include "common/segments/segment_labels.h"

namespace conav::nhpm {
namespace {

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

/// Boundaries chosen where the baseline's was.
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
