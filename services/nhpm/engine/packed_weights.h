#pragma once

#include <array>
#include <vector>

#include "nhpm/engine/aligned_floats.h"
#include "nhpm/engine/network_weights.h"

namespace conav::nhpm {

/// Parameters in the order in which the kernels read them, so that a tile walks through them once:
///
///   layers 0, 1, 2   blocks of 16 outputs, each [ky][kx][inputs][16]
///   layer 3          [ky][kx][inputs / 8][kOutputChannels][8]
///   backward         of layers 1, 2, 3: blocks of 16 INPUTS, each [2-ky][2-kx][outputs][16]
struct PackedWeights {
  /// Backward weights are left out of what only infers.
  enum class Use { kInference, kTraining };

  PackedWeights(const NetworkWeights& weights, Use use);
  /// New values of the same shape.
  void Assign(const NetworkWeights& weights);

  NetworkShape shape;
  std::array<AlignedFloats, kNetworkLayers> forward;
  std::array<AlignedFloats, kNetworkLayers> backward;  // [0] stays empty
  std::array<std::vector<float>, kNetworkLayers> biases;
};

}  // namespace conav::nhpm
