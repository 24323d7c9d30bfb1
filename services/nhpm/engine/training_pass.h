#pragma once

#include <memory>
#include <optional>
#include <span>

#include "nhpm/engine/encoder_decoder.h"
#include "nhpm/engine/packed_weights.h"

// One user: batches; tests check its gradients.

namespace conav::nhpm {

/// Weights for forward and backward passes: in the kernels' order, or as they are for an
/// encoder-decoder, whose passes each choose an order of their own.
class TrainingWeights {
 public:
  explicit TrainingWeights(const NetworkWeights& weights) { Assign(weights); }
  /// New values of the same shape.
  void Assign(const NetworkWeights& weights) {
    if (weights.shape.architecture == Architecture::kEncoderDecoder) {
      plain_ = std::make_shared<const NetworkWeights>(weights);
    } else if (packed_) {
      packed_->Assign(weights);
    } else {
      packed_.emplace(weights, PackedWeights::Use::kTraining);
    }
  }

 private:
  friend class TrainingPass;
  std::optional<PackedWeights> packed_;
  std::shared_ptr<const NetworkWeights> plain_;
};

/// Runs one sample forward and backward through the network, with the code of inference: the logits
/// have its bits. The convolutional network's results are equal whatever the instruction set; an
/// encoder-decoder's are on one kind of processor (encoder_decoder.h). Threads: one pass per thread; threads may share the weights while none calls
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
  std::unique_ptr<Workspace> workspace_;                 // of the convolutional network
  std::unique_ptr<EncoderDecoderPass> encoder_decoder_;  // else
};

}  // namespace conav::nhpm
