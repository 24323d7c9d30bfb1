#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "nhpm/engine/training_pass.h"
#include "nhpm/training/augmentation.h"

namespace conav::nhpm {

/// log(1 + exp(x)), with a relative error below 1e-15, of plain double operations: the same bits on
/// every machine, so that early stopping keeps the same weights everywhere.
double Softplus(double x);

/// Mean binary cross-entropy (MBCE) of one example over ALL its outputs; masked ones cost 0:
///
///   sum over unmasked of (softplus(logit) - y logit)  /  (rows columns kOutputChannels)
///
/// The terms of edited outputs count `class_weight` times; 1 is the MBCE, the paper's encoder-decoder
/// has 338. Source: paper Appendix B.
double ExampleLoss(std::span<const float> logits, std::span<const OutputLabel> labels,
                   double class_weight = 1.0);

/// d ExampleLoss / d logit, times `factor`: factor (sigmoid(logit) - y) / outputs, 0 where masked,
/// class_weight times where edited.
void LossGradient(std::span<const float> logits, std::span<const OutputLabel> labels, float factor,
                  std::span<float> gradient, double class_weight = 1.0);

/// An example and its variant (Augmentation).
struct BatchItem {
  const Example* example = nullptr;
  std::uint64_t variant = 0;
};

/// Loss and gradient over batches, on several threads.
///
/// The bits do not depend on the number of threads: a batch is cut into kChunks runs of examples.
/// One thread adds up the gradient of a chunk in order; then the chunks are added in order.
class BatchPass {
 public:
  static constexpr int kChunks = 16;

  /// Examples of that shape, with their symmetries.
  BatchPass(NetworkShape shape, int rows, int columns, int threads);
  /// Examples as `augmentation` makes them.
  BatchPass(NetworkShape shape, std::unique_ptr<const Augmentation> augmentation, int threads,
            double class_weight);
  ~BatchPass();

  const Augmentation& augmentation() const { return *augmentation_; }

  /// Returns the sum of the items' losses; `gradient` becomes the gradient of their mean.
  double Gradient(const TrainingWeights& weights, std::span<const BatchItem> batch,
                  NetworkWeights& gradient);

  /// The loss of each example, in its fixed variant.
  std::vector<double> Losses(const TrainingWeights& weights, std::span<const Example> examples);
  /// Their mean. Requires at least one.
  double MeanLoss(const TrainingWeights& weights, std::span<const Example> examples);

 private:
  struct Worker;
  double Loss(std::span<const float> logits, std::span<const OutputLabel> labels) const {
    return ExampleLoss(logits, labels, class_weight_);
  }
  void AddExample(const TrainingWeights& weights, const BatchItem& item, float factor,
                  Worker& worker, NetworkWeights& gradient, double& loss);
  void SumChunks(NetworkWeights& gradient) const;

  std::unique_ptr<const Augmentation> augmentation_;
  double class_weight_;
  std::vector<std::unique_ptr<Worker>> workers_;
  std::vector<NetworkWeights> chunk_gradients_;
};

}  // namespace conav::nhpm
