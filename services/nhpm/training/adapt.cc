#include "nhpm/training/adapt.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>

#include "common/runtime/demand.h"
#include "common/runtime/random.h"
#include "nhpm/training/fine_tuning.h"

namespace conav::nhpm {
namespace {

constexpr std::uint64_t kFoldSeed = 1;  // purpose of a seed; kEpochSeed is another

/// One part of the groups to learn from, the rest to measure on.
struct Fold {
  std::vector<const Example*> train;
  std::vector<Example> held_out;
};

std::vector<Fold> DealFolds(const std::vector<ExampleSet>& groups, const AdaptOptions& options) {
  std::vector<std::size_t> order(groups.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  Random random(DeriveSeed(options.seed, kFoldSeed));
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

/// Loss of each example while it was held out.
using HeldOutLosses = std::vector<double>;

double MeanOf(const HeldOutLosses& losses) {
  return std::accumulate(losses.begin(), losses.end(), 0.0) / static_cast<double>(losses.size());
}

/// Mean of base - adapted, less two standard errors of this mean.
double CertainGain(const HeldOutLosses& base, const HeldOutLosses& adapted) {
  const auto count = static_cast<double>(base.size());
  const double gain = MeanOf(base) - MeanOf(adapted);
  double squares = 0.0;
  for (std::size_t i = 0; i < base.size(); ++i) {
    const double deviation = base[i] - adapted[i] - gain;
    squares += deviation * deviation;
  }
  return gain - 2.0 * std::sqrt(squares / (count * std::max(1.0, count - 1.0)));
}

/// The lowest held-out loss that fine-tuning with one pull came to, and after how many epochs.
struct Tried {
  double pull = 0.0;
  int epochs = 0;
  HeldOutLosses base;
  HeldOutLosses losses;
};

/// One fold's losses after another, after `epoch` epochs; runs the last of them unless it is 0.
HeldOutLosses RunFolds(Run& run, const std::vector<Fold>& folds,
                       const std::vector<std::unique_ptr<FineTuning>>& tunings, int epoch) {
  HeldOutLosses all;
  for (std::size_t i = 0; i < folds.size(); ++i) {
    if (epoch > 0) tunings[i]->RunEpoch(run.symmetries);
    const auto losses = run.pass.Losses(tunings[i]->packed(), folds[i].held_out);
    all.insert(all.end(), losses.begin(), losses.end());
  }
  return all;
}

Result<Tried> CrossValidate(Run& run, double pull) {
  const std::vector<Fold> folds = DealFolds(run.groups, run.options);
  std::vector<std::unique_ptr<FineTuning>> tunings;
  for (const Fold& fold : folds) {
    tunings.push_back(
        std::make_unique<FineTuning>(run.base, fold.train, run.options, pull, run.pass));
  }
  Tried best{pull, 0, RunFolds(run, folds, tunings, 0), {}};
  best.losses = best.base;
  for (int epoch = 1; epoch <= run.options.epochs; ++epoch) {
    if (run.stop.stop_requested()) return Fail(ErrorCode::kUnavailable, "stopped");
    HeldOutLosses losses = RunFolds(run, folds, tunings, epoch);
    if (MeanOf(losses) < MeanOf(best.losses)) {
      best.epochs = epoch;
      best.losses = std::move(losses);
    }
    if (epoch - best.epochs >= run.options.patience) break;
  }
  return best;
}

/// Pull and epochs of the lowest held-out loss; the base where its gain is not certain.
Result<Adaptation> Choose(Run& run) {
  std::optional<Tried> best;
  for (const double pull : run.options.pulls) {
    auto tried = CrossValidate(run, pull);
    if (!tried) return tl::unexpected(tried.error());
    if (!best || MeanOf(tried->losses) < MeanOf(best->losses)) best = std::move(*tried);
  }
  const double base_loss = MeanOf(best->base);
  if (CertainGain(best->base, best->losses) <= 0.0)
    return Adaptation{{}, 0.0, 0, base_loss, base_loss};
  return Adaptation{{}, best->pull, best->epochs, base_loss, MeanOf(best->losses)};
}

}  // namespace

Result<Adaptation> Adapt(const NetworkWeights& base, const std::vector<ExampleSet>& groups,
                         const AdaptOptions& options, int threads, const StopToken& stop) {
  DEMAND(!options.pulls.empty() && options.folds >= 2, options.pulls.size(), options.folds);
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
  FineTuning tuning(base, AllExamples(used), options, chosen->pull, run.pass);
  for (int epoch = 0; epoch < chosen->epochs; ++epoch) tuning.RunEpoch(run.symmetries);
  chosen->weights = tuning.weights();
  return chosen;
}

}  // namespace conav::nhpm
