#pragma once

#include <memory>
#include <span>
#include <vector>

#include "nhpm/engine/training_pass.h"
#include "nhpm/training/augmentation.h"

namespace conav::nhpm {

/// An example and how it is turned.
struct BatchItem {
  const Example* example = nullptr;
  int symmetry = 0;
};

/// Loss and gradient over batches, on several threads.
///
/// The bits do not depend on the number of threads: a batch is cut into kChunks runs of examples,
/// each with a gradient of its own that one thread adds up in order; the chunks are then added in
/// order.
class BatchPass {
 public:
  static constexpr int kChunks = 16;

  BatchPass(NetworkShape shape, int rows, int columns, int threads);
  ~BatchPass();

  /// The sum of the items' losses; `gradient` becomes the gradient of their mean.
  double Gradient(const TrainingWeights& weights, std::span<const BatchItem> batch,
                  NetworkWeights& gradient);

  /// The loss of each example.
  std::vector<double> Losses(const TrainingWeights& weights, std::span<const Example> examples);
  /// Their mean. Requires at least one.
  double MeanLoss(const TrainingWeights& weights, std::span<const Example> examples);

 private:
  struct Worker;
  void AddExample(const TrainingWeights& weights, const BatchItem& item, float factor,
                  Worker& worker, NetworkWeights& gradient, double& loss);
  void SumChunks(NetworkWeights& gradient) const;

  GridSymmetries symmetries_;
  std::vector<std::unique_ptr<Worker>> workers_;
  std::vector<NetworkWeights> chunk_gradients_;
};

}  // namespace conav::nhpm
