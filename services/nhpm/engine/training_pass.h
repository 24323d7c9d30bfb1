#pragma once

#include <memory>
#include <span>

#include "nhpm/engine/packed_weights.h"

// One user: the trainer; tests check its gradients.

namespace conav::nhpm {

/// Weights in the kernels' order, for forward and backward passes.
class TrainingWeights {
 public:
  explicit TrainingWeights(const NetworkWeights& weights)
      : packed_(weights, PackedWeights::Use::kTraining) {}
  /// Packs new values of the same shape.
  void Assign(const NetworkWeights& weights) { packed_.Assign(weights); }

 private:
  friend class TrainingPass;
  PackedWeights packed_;
};

/// Runs one sample forward and backward through the network, with the kernels of the inference
/// engine: the logits have the bits of inference, and all results are equal whatever the
/// instruction set. Threads: one pass per thread; threads may share the weights while none calls
/// Assign.
class TrainingPass {
 public:
  TrainingPass(NetworkShape shape, int rows, int columns);
  ~TrainingPass();

  /// `input` has shape [rows][columns][kInputChannels]. Returns logits, shape
  /// [rows][columns][kOutputChannels], valid until the next call.
  std::span<const float> Forward(const TrainingWeights& weights, std::span<const float> input);

  /// After Forward: adds d loss / d parameter to `gradient`, for d loss / d logit given in
  /// `logit_gradient` (shape as the logits).
  void Backward(const TrainingWeights& weights, std::span<const float> logit_gradient,
                NetworkWeights& gradient);

 private:
  struct Workspace;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace conav::nhpm
