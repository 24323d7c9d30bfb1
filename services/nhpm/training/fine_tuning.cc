#include "nhpm/training/fine_tuning.h"

#include <algorithm>
#include <span>

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

}  // namespace

FineTuning::FineTuning(const NetworkWeights& base, const std::vector<const Example*>& examples,
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

void FineTuning::RunEpoch(int symmetries) {
  random_.Shuffle(items_);
  for (BatchItem& item : items_) {
    item.symmetry = static_cast<int>(random_.Uniform(0, symmetries - 1));
  }
  const auto batch = static_cast<std::size_t>(options_.batch);
  for (std::size_t i = 0; i < items_.size(); i += batch) {
    Step(std::span(items_).subspan(i, std::min(batch, items_.size() - i)));
  }
  packed_mean_.Assign(mean_);
}

void FineTuning::Step(std::span<const BatchItem> batch) {
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

}  // namespace conav::nhpm
