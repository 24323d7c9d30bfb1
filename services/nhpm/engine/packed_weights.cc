#include "nhpm/engine/packed_weights.h"

#include <algorithm>

#include "common/runtime/result.h"
#include "nhpm/engine/kernels.h"

namespace conav::nhpm {
namespace {

std::size_t CanonicalIndex(int k, int input, int inputs, int output, int outputs) {
  return static_cast<std::size_t>((k * inputs + input) * outputs + output);
}

/// Blocks of 16 outputs, each [ky][kx][inputs][16].
void PackBlocks(const std::vector<float>& weights, int inputs, int outputs, AlignedFloats& packed) {
  auto next = packed.begin();
  for (int block = 0; block < outputs; block += kBlock) {
    for (int k = 0; k < 9; ++k) {
      for (int input = 0; input < inputs; ++input) {
        const auto from = weights.begin() + static_cast<std::ptrdiff_t>(
                                                CanonicalIndex(k, input, inputs, block, outputs));
        next = std::copy(from, from + kBlock, next);
      }
    }
  }
}

void PackLast(const std::vector<float>& weights, int inputs, AlignedFloats& packed) {
  auto next = packed.begin();
  for (int k = 0; k < 9; ++k) {
    for (int block = 0; block < inputs; block += kLanes) {
      for (int output = 0; output < kOutputChannels; ++output) {
        for (int i = 0; i < kLanes; ++i) {
          *next++ = weights[CanonicalIndex(k, block + i, inputs, output, kOutputChannels)];
        }
      }
    }
  }
}

/// Weights of the convolution that carries gradients back: rotated by 180 degrees, inputs and
/// outputs swapped.
void PackBackward(const std::vector<float>& weights, int inputs, int outputs,
                  AlignedFloats& packed) {
  auto next = packed.begin();
  for (int block = 0; block < inputs; block += kBlock) {
    for (int k = 8; k >= 0; --k) {
      for (int output = 0; output < outputs; ++output) {
        for (int i = 0; i < kBlock; ++i) {
          *next++ = weights[CanonicalIndex(k, block + i, inputs, output, outputs)];
        }
      }
    }
  }
}

}  // namespace

PackedWeights::PackedWeights(const NetworkWeights& weights, Use use) : shape(weights.shape) {
  DEMAND(shape.architecture == Architecture::kConvolutional && IsNetworkWidth(shape.width),
         shape.width);
  for (int layer = 0; layer < kNetworkLayers; ++layer) {
    const auto i = static_cast<std::size_t>(layer);
    forward[i].resize(shape.WeightsOf(layer));
    if (use == Use::kTraining && layer > 0) backward[i].resize(shape.WeightsOf(layer));
  }
  Assign(weights);
}

void PackedWeights::Assign(const NetworkWeights& weights) {
  DEMAND(weights.shape == shape, weights.shape.width, shape.width);
  for (int layer = 0; layer < kNetworkLayers; ++layer) {
    const auto i = static_cast<std::size_t>(layer);
    const int inputs = shape.InputsOf(layer);
    const int outputs = shape.OutputsOf(layer);
    biases[i] = weights.biases[i];
    if (layer == kNetworkLayers - 1) {
      PackLast(weights.weights[i], inputs, forward[i]);
    } else {
      PackBlocks(weights.weights[i], inputs, outputs, forward[i]);
    }
    if (!backward[i].empty()) PackBackward(weights.weights[i], inputs, outputs, backward[i]);
  }
}

}  // namespace conav::nhpm
