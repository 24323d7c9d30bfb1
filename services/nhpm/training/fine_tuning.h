#pragma once

#include <vector>

#include "common/runtime/random.h"
#include "nhpm/training/adam.h"
#include "nhpm/training/adapt.h"
#include "nhpm/training/batch_pass.h"

namespace conav::nhpm {

/// The last layers of a network learn from one person's examples, pulled towards the weights that
/// they start from: the loss has pull / 2 ||weights - base||^2 added.
class FineTuning {
 public:
  static constexpr std::uint64_t kEpochSeed = 2;  // purpose of a seed

  /// Keeps references to all but `pull`; the examples must stay, too.
  FineTuning(const NetworkWeights& base, const std::vector<const Example*>& examples,
             const AdaptOptions& options, double pull, BatchPass& pass);

  /// Each example once, in one of so many symmetries, drawn at random.
  void RunEpoch(int symmetries);

  /// The moving mean (AdaptOptions::averaging).
  const TrainingWeights& packed() const { return packed_mean_; }
  const NetworkWeights& weights() const { return mean_; }

 private:
  void Step(std::span<const BatchItem> batch);

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

}  // namespace conav::nhpm
