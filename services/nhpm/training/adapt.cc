#include "nhpm/training/adapt.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "common/runtime/random.h"
#include "nhpm/training/adam.h"
#include "nhpm/training/batch_pass.h"

namespace conav::nhpm {
namespace {

constexpr std::uint64_t kFolds = 1;  // purposes of seeds
constexpr std::uint64_t kEpochs = 2;

/// gradient += pull (values - base).
void AddPull(float pull, const std::vector<float>& values, const std::vector<float>& base,
             std::vector<float>& gradient) {
  for (std::size_t i = 0; i < gradient.size(); ++i) gradient[i] += pull * (values[i] - base[i]);
}

/// Fine-tuning on some groups with one pull.
class Adapter {
 public:
  Adapter(const NetworkWeights& base, std::vector<const Example*> examples,
          const AdaptOptions& options, double pull, BatchPass& pass)
      : base_(base),
        options_(options),
        pull_(static_cast<float>(pull)),
        pass_(pass),
        random_(DeriveSeed(options.seed, kEpochs)),
        weights_(base),
        packed_(base),
        adam_(InitialAdamState(base.shape)),
        gradient_(ZeroWeights(base.shape)) {
    for (const Example* example : examples) items_.push_back({example, 0});
  }

  void RunEpoch(int symmetries) {
    random_.Shuffle(items_);
    for (BatchItem& item : items_) {
      item.symmetry = static_cast<int>(random_.Uniform(0, symmetries - 1));
    }
    const auto batch = static_cast<std::size_t>(options_.batch);
    for (std::size_t i = 0; i < items_.size(); i += batch) {
      Step(std::span(items_).subspan(i, std::min(batch, items_.size() - i)));
    }
  }

  const TrainingWeights& packed() const { return packed_; }
  const NetworkWeights& weights() const { return weights_; }

 private:
  void Step(std::span<const BatchItem> batch) {
    pass_.Gradient(packed_, batch, gradient_);
    for (auto i = static_cast<std::size_t>(kFirstAdaptedLayer); i < kNetworkLayers; ++i) {
      AddPull(pull_, weights_.weights[i], base_.weights[i], gradient_.weights[i]);
      AddPull(pull_, weights_.biases[i], base_.biases[i], gradient_.biases[i]);
    }
    AdamStep({.learning_rate = static_cast<float>(options_.learning_rate)}, gradient_, adam_,
             weights_, kFirstAdaptedLayer);
    packed_.Assign(weights_);
  }

  const NetworkWeights& base_;
  const AdaptOptions& options_;
  float pull_;
  BatchPass& pass_;
  Random random_;
  NetworkWeights weights_;
  TrainingWeights packed_;
  AdamState adam_;
  NetworkWeights gradient_;
  std::vector<BatchItem> items_;
};

/// One part of the groups to learn from, the rest to measure on.
struct Fold {
  std::vector<const Example*> train;
  std::vector<Example> held_out;
};

std::vector<Fold> DealFolds(const std::vector<ExampleSet>& groups, const AdaptOptions& options) {
  std::vector<std::size_t> order(groups.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  Random random(DeriveSeed(options.seed, kFolds));
  random.Shuffle(order);
  std::vector<Fold> folds(std::min(groups.size(), static_cast<std::size_t>(options.folds)));
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t fold = 0; fold < folds.size(); ++fold) {
      for (const Example& example : groups[order[i]].examples) {
        if (i % folds.size() == fold) {
          folds[fold].held_out.push_back(example);
        } else {
          folds[fold].train.push_back(&example);
        }
      }
    }
  }
  return folds;
}

std::vector<const Example*> AllExamples(const std::vector<ExampleSet>& groups) {
  std::vector<const Example*> examples;
  for (const ExampleSet& group : groups) {
    for (const Example& example : group.examples) examples.push_back(&example);
  }
  return examples;
}

/// All that the stages of one adaptation share.
struct Run {
  const NetworkWeights& base;
  const std::vector<ExampleSet>& groups;
  const AdaptOptions& options;
  const StopToken& stop;
  int symmetries;
  BatchPass pass;
};

/// Held-out loss summed over all folds' examples, after 0, 1, 2, ... epochs.
Result<std::vector<double>> CrossValidate(Run& run, double pull) {
  std::vector<double> losses(static_cast<std::size_t>(run.options.epochs) + 1, 0.0);
  for (const Fold& fold : DealFolds(run.groups, run.options)) {
    Adapter adapter(run.base, fold.train, run.options, pull, run.pass);
    const auto count = static_cast<double>(fold.held_out.size());
    for (double& loss : losses) {
      if (&loss != &losses.front()) adapter.RunEpoch(run.symmetries);
      if (run.stop.stop_requested()) return Fail(ErrorCode::kUnavailable, "stopped");
      loss += count * run.pass.MeanLoss(adapter.packed(), fold.held_out);
    }
  }
  return losses;
}

/// Pull and epochs of the lowest held-out loss; the base where nothing is below it.
Result<Adaptation> Choose(Run& run) {
  const auto examples = static_cast<double>(AllExamples(run.groups).size());
  Adaptation best;
  for (const double pull : run.options.pulls) {
    const auto losses = CrossValidate(run, pull);
    if (!losses) return tl::unexpected(losses.error());
    best.base_loss = losses->front() / examples;
    if (pull == run.options.pulls.front()) best.held_out_loss = best.base_loss;
    const auto lowest = std::min_element(losses->begin(), losses->end());
    if (*lowest / examples >= best.held_out_loss) continue;
    best.held_out_loss = *lowest / examples;
    best.epochs = static_cast<int>(lowest - losses->begin());
    best.pull = pull;
  }
  return best;
}

}  // namespace

Result<Adaptation> Adapt(const NetworkWeights& base, const std::vector<ExampleSet>& groups,
                         const AdaptOptions& options, int threads, const StopToken& stop) {
  std::vector<ExampleSet> used = groups;
  std::erase_if(used, [](const ExampleSet& group) { return group.examples.empty(); });
  if (used.size() < 2) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{} to adapt to; it takes two at least, to learn from one and measure "
                            "on the other",
                            used.empty() ? "nothing" : "only one segment"));
  }
  const int rows = used[0].rows;
  const int columns = used[0].columns;
  Run run{base,
          used,
          options,
          stop,
          GridSymmetries(rows, columns).count(),
          BatchPass(base.shape, rows, columns, threads)};
  auto chosen = Choose(run);
  if (!chosen) return chosen;
  Adapter adapter(base, AllExamples(used), options, chosen->pull, run.pass);
  for (int epoch = 0; epoch < chosen->epochs; ++epoch) adapter.RunEpoch(run.symmetries);
  chosen->weights = adapter.weights();
  return chosen;
}

}  // namespace conav::nhpm
