#include "nhpm/training/adapt.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <span>

#include "common/runtime/random.h"
#include "nhpm/engine/training_pass.h"
#include "nhpm/model/encoding.h"
#include "nhpm/training/batch_pass.h"
#include "nhpm/training/trainer.h"

namespace conav::nhpm {
namespace {

/// gradient += pull (values - base).
void AddPull(float pull, const std::vector<float>& values, const std::vector<float>& base,
             std::vector<float>& gradient) {
  for (std::size_t i = 0; i < gradient.size(); ++i) gradient[i] += pull * (values[i] - base[i]);
}

/// mean += share (values - mean).
void MixIn(float share, const std::vector<float>& values, std::vector<float>& mean) {
  for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += share * (values[i] - mean[i]);
}

/// Fine-tunes the last layers of a network on one person's examples, pulled towards the initial
/// weights: the loss includes pull / 2 ||weights - base||^2.
class FineTuning {
 public:
  static constexpr std::uint64_t kEpochSeed = 2;  // purpose of a seed

  /// Keeps references to all arguments but `pull`; the examples must outlive it, too.
  FineTuning(const NetworkWeights& base, const std::vector<const Example*>& examples,
             const AdaptOptions& options, double pull, BatchPass& pass)
      : base_(base),
        options_(options),
        pull_(static_cast<float>(pull)),
        pass_(pass),
        random_(DeriveSeed(options.seed, kEpochSeed)),
        weights_(base),
        packed_(base),
        mean_(base),
        packed_mean_(base),
        adam_(InitialAdamState(base.shape)),
        gradient_(ZeroWeights(base.shape)) {
    for (const Example* example : examples) items_.push_back({example, 0});
  }

  /// Takes each example once, in a random symmetry.
  void RunEpoch() {
    random_.Shuffle(items_);
    for (BatchItem& item : items_) {
      item.variant = pass_.augmentation().Draw(random_);
    }
    const auto batch = static_cast<std::size_t>(options_.batch);
    for (std::size_t i = 0; i < items_.size(); i += batch) {
      Step(std::span(items_).subspan(i, std::min(batch, items_.size() - i)));
    }
    packed_mean_.Assign(mean_);
  }

  /// The moving mean (AdaptOptions::averaging).
  const TrainingWeights& packed() const { return packed_mean_; }
  const NetworkWeights& weights() const { return mean_; }

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
    const auto share = static_cast<float>(options_.averaging);
    for (auto i = static_cast<std::size_t>(kFirstAdaptedLayer); i < kNetworkLayers; ++i) {
      MixIn(share, weights_.weights[i], mean_.weights[i]);
      MixIn(share, weights_.biases[i], mean_.biases[i]);
    }
  }

  const NetworkWeights& base_;
  const AdaptOptions& options_;
  float pull_;
  BatchPass& pass_;
  Random random_;
  NetworkWeights weights_;
  TrainingWeights packed_;
  NetworkWeights mean_;
  TrainingWeights packed_mean_;
  AdamState adam_;
  NetworkWeights gradient_;
  std::vector<BatchItem> items_;
};

constexpr std::size_t kMostNamed = 8;

std::string NamesOf(const std::vector<Person>& people) {
  std::string text;
  for (std::size_t i = 0; i < std::min(people.size(), kMostNamed); ++i) {
    text += fmt::format("{}{}", i == 0 ? "" : ", ", people[i].participant);
  }
  return people.size() > kMostNamed ? text + ", ..." : text;
}

std::vector<ExampleSet> OnePerExample(const ExampleSet& set) {
  std::vector<ExampleSet> groups;
  for (const Example& example : set.examples) groups.push_back({set.rows, set.columns, {example}});
  return groups;
}

constexpr std::uint64_t kFoldSeed = 1;  // purpose of a seed; kEpochSeed is another

/// One part of the groups for measuring, the rest for learning.
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

/// One output of the network, unmasked.
struct Observation {
  double logit = 0.0;
  bool edited = false;
};

struct Line {
  double slope = 1.0;
  double offset = 0.0;
};

/// The most probable line through the logits, by Newton's method: cross-entropy plus the deviations
/// of `options` as a normal prior around the identity.
Line FitLine(const std::vector<Observation>& seen, const AdaptOptions& options) {
  const double slope_weight = 1.0 / (options.slope_deviation * options.slope_deviation);
  const double offset_weight = 1.0 / (options.offset_deviation * options.offset_deviation);
  Line line;
  for (int i = 0; i < 30; ++i) {
    double slope = slope_weight * (line.slope - 1.0);  // gradient
    double offset = offset_weight * line.offset;
    double aa = slope_weight;  // curvature
    double ab = 0.0;
    double bb = offset_weight;
    for (const auto& [logit, edited] : seen) {
      const auto p =
          static_cast<double>(Sigmoid(static_cast<float>(line.slope * logit + line.offset)));
      slope += (p - edited) * logit;
      offset += p - edited;
      aa += p * (1.0 - p) * logit * logit;
      ab += p * (1.0 - p) * logit;
      bb += p * (1.0 - p);
    }
    const double determinant = aa * bb - ab * ab;
    line.slope -= std::clamp((bb * slope - ab * offset) / determinant, -0.5, 0.5);
    line.offset -= std::clamp((aa * offset - ab * slope) / determinant, -1.0, 1.0);
  }
  return line;
}

/// Stage 1, folded into the last layer.
NetworkWeights Calibrate(const NetworkWeights& base, const std::vector<const Example*>& examples,
                         int rows, int columns, const AdaptOptions& options) {
  std::array<std::vector<Observation>, kOutputChannels> seen;
  TrainingPass pass(base.shape, rows, columns);
  const TrainingWeights packed(base);
  for (const Example* example : examples) {
    const std::span<const float> logits = pass.Forward(packed, example->input);
    for (std::size_t i = 0; i < logits.size(); ++i) {
      if (example->labels[i] == OutputLabel::kMasked) continue;
      seen[i % kOutputChannels].push_back(
          {static_cast<double>(logits[i]), example->labels[i] == OutputLabel::kEdited});
    }
  }
  NetworkWeights result = base;
  for (std::size_t output = 0; output < kOutputChannels; ++output) {
    const Line line = FitLine(seen[output], options);
    const auto slope = static_cast<float>(line.slope);
    auto& weights = result.weights.back();
    for (std::size_t i = output; i < weights.size(); i += kOutputChannels) weights[i] *= slope;
    float& bias = result.biases.back()[output];
    bias = bias * slope + static_cast<float>(line.offset);
  }
  return result;
}

/// The state that the stages of one adaptation share.
struct Run {
  const NetworkWeights& base;
  const std::vector<ExampleSet>& groups;
  const AdaptOptions& options;
  const StopToken& stop;
  BatchPass pass;
};

/// Loss of each example while held out.
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

/// The lowest held-out loss of fine-tuning with one pull, and its number of epochs.
struct Tried {
  double pull = 0.0;
  int epochs = 0;
  HeldOutLosses calibrated;
  HeldOutLosses losses;
};

/// Concatenates the folds' losses after `epoch` epochs; runs the last of them unless it is 0.
HeldOutLosses RunFolds(Run& run, const std::vector<Fold>& folds,
                       const std::vector<std::unique_ptr<FineTuning>>& tunings, int epoch) {
  HeldOutLosses all;
  for (std::size_t i = 0; i < folds.size(); ++i) {
    if (epoch > 0) tunings[i]->RunEpoch();
    const auto losses = run.pass.Losses(tunings[i]->packed(), folds[i].held_out);
    all.insert(all.end(), losses.begin(), losses.end());
  }
  return all;
}

Result<Tried> CrossValidate(Run& run, const std::vector<Fold>& folds,
                            const std::vector<NetworkWeights>& calibrated, double pull) {
  std::vector<std::unique_ptr<FineTuning>> tunings;
  for (std::size_t i = 0; i < folds.size(); ++i) {
    tunings.push_back(
        std::make_unique<FineTuning>(calibrated[i], folds[i].train, run.options, pull, run.pass));
  }
  Tried best{pull, 0, RunFolds(run, folds, tunings, 0), {}};
  best.losses = best.calibrated;
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

/// Pull and epochs of the lowest held-out loss; without fine-tuning if its gain is not certain.
Result<Adaptation> Choose(Run& run) {
  const std::vector<Fold> folds = DealFolds(run.groups, run.options);
  const auto& [rows, columns, _] = run.groups.front();
  std::vector<NetworkWeights> calibrated;
  HeldOutLosses base;
  const TrainingWeights packed(run.base);
  for (const Fold& fold : folds) {
    calibrated.push_back(Calibrate(run.base, fold.train, rows, columns, run.options));
    const auto losses = run.pass.Losses(packed, fold.held_out);
    base.insert(base.end(), losses.begin(), losses.end());
  }
  std::optional<Tried> best;
  for (const double pull : run.options.pulls) {
    auto tried = CrossValidate(run, folds, calibrated, pull);
    if (!tried) return tl::unexpected(tried.error());
    if (!best || MeanOf(tried->losses) < MeanOf(best->losses)) best = std::move(*tried);
  }
  const double base_loss = MeanOf(base);
  if (CertainGain(best->calibrated, best->losses) > 0.0) {
    return Adaptation{{}, best->pull, best->epochs, true, base_loss, MeanOf(best->losses)};
  }
  const double loss = MeanOf(best->calibrated);
  if (loss < base_loss) return Adaptation{{}, 0.0, 0, true, base_loss, loss};
  return Adaptation{{}, 0.0, 0, false, base_loss, base_loss};
}

}  // namespace

std::vector<Person> PeopleOf(const SegmentSet& set) {
  std::vector<Person> people;
  for (const Trajectory& trajectory : set.trajectories) {
    auto found = std::find_if(people.begin(), people.end(), [&](const Person& person) {
      return person.participant == trajectory.participant;
    });
    if (found == people.end()) {
      people.push_back({trajectory.participant, {}});
      found = people.end() - 1;
    }
    found->set.trajectories.push_back(trajectory);
  }
  return people;
}

Result<Person> FindPerson(const std::vector<Person>& people, const std::string& participant) {
  if (participant.empty() && people.size() == 1) return people.front();
  for (const Person& person : people) {
    if (!participant.empty() && person.participant == participant) return person;
  }
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("{}; there are {} ({})",
                          participant.empty() ? "--participant must name one of them"
                                              : "no participant '" + participant + "'",
                          people.size(), NamesOf(people)));
}

std::vector<ExampleSet> AdaptationGroups(const SegmentSet& set, const InputSelection& inputs) {
  std::vector<ExampleSet> groups;
  for (const Trajectory& trajectory : set.trajectories) {
    groups.push_back(ExamplesOf({{trajectory}}, inputs));
  }
  return groups.size() == 1 ? OnePerExample(groups.front()) : groups;
}

Result<Adaptation> Adapt(const NetworkWeights& base, const std::vector<ExampleSet>& groups,
                         const AdaptOptions& options, int threads, const StopToken& stop) {
  DEMAND(!options.pulls.empty() && options.folds >= 2, options.pulls.size(), options.folds);
  std::vector<ExampleSet> used = groups;
  std::erase_if(used, [](const ExampleSet& group) { return group.examples.empty(); });
  if (used.size() < 2) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format(
            "{} to adapt to; at least two are needed, one to learn from and one to measure on",
            used.empty() ? "nothing" : "only one segment"));
  }
  const int rows = used[0].rows;
  const int columns = used[0].columns;
  Run run{base, used, options, stop, BatchPass(base.shape, rows, columns, threads)};
  auto chosen = Choose(run);
  if (!chosen) return chosen;
  const std::vector<const Example*> all = AllExamples(used);
  const NetworkWeights start =
      chosen->calibrated ? Calibrate(base, all, rows, columns, options) : base;
  FineTuning tuning(start, all, options, chosen->pull, run.pass);
  for (int epoch = 0; epoch < chosen->epochs; ++epoch) tuning.RunEpoch();
  chosen->weights = tuning.weights();
  return chosen;
}

}  // namespace conav::nhpm
