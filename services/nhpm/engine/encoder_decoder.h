#pragma once

#include <memory>
#include <span>
#include <vector>

#include "nhpm/engine/network_weights.h"

namespace conav::nhpm {

/// Rows and columns of a layer's output.
struct LayerSize {
  int rows = 0;
  int columns = 0;
  bool operator==(const LayerSize&) const = default;
};

/// The outputs of the encoder-decoder's 13 convolutions for an input of that size. Layers 1, 3 and 5
/// have stride 2 and halve the size, rounding up: 150 -> 75 -> 38 -> 19. Layer 6 is the bottleneck,
/// 4 width channels. Before layers 7, 9 and 11 the values are upsampled to the size that the
/// encoder had there: 19 -> 38 -> 75 -> 150. So every size from 1 x 1 works.
/// Source: paper Appendix B (64 x 19 x 19 for 150 x 150, width 16); upsampling instead of transposed
/// convolutions, no skip connections.
std::vector<LayerSize> EncoderDecoderSizes(int rows, int columns);

/// The row (or column) of `from` from which upsampling to `to` takes its value: the nearest
/// neighbour floor(i from / to). Our own, because libraries differ in it.
constexpr int UpsamplingSource(int i, int from, int to) { return i * from / to; }

/// Runs one sample through an encoder-decoder, forward and, for training, backward. The
/// convolutions are oneDNN's, on the calling thread only.
///
/// Equal inputs give equal bits on processors with the same instruction set, also in training and
/// inference; oneDNN sums in another order on others.
/// Threads: one pass per thread.
class EncoderDecoderPass {
 public:
  enum class Use { kInference, kTraining };

  /// Memory grows with rows * columns: about 9 MB for inference at 150 x 150 and width 16.
  EncoderDecoderPass(NetworkShape shape, int rows, int columns, Use use);
  ~EncoderDecoderPass();

  /// Before the first Forward; free when they are those already set.
  void SetWeights(const std::shared_ptr<const NetworkWeights>& weights);

  /// `input` has shape [rows][columns][kInputChannels]. Returns logits, shape
  /// [rows][columns][kOutputChannels], valid until the next call.
  std::span<const float> Forward(std::span<const float> input);

  /// After Forward: adds d loss / d parameter to `gradient`, for d loss / d logit given in
  /// `logit_gradient` (shape as the logits). Requires Use::kTraining.
  void Backward(std::span<const float> logit_gradient, NetworkWeights& gradient);

  int rows() const { return rows_; }
  int columns() const { return columns_; }

 private:
  struct Network;  // keeps oneDNN out of this header

  int rows_;
  int columns_;
  std::unique_ptr<Network> network_;
};

}  // namespace conav::nhpm
