#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace conav::nhpm {

inline constexpr int kNetworkLayers = 4;
inline constexpr int kInputChannels = 4;
inline constexpr int kOutputChannels = 2;

/// The fully convolutional network of paper Appendix B: 4 convolutions 3x3, stride 1, zero padding
/// 1, ReLU between them; inputs -> width -> width -> width -> outputs. Receptive field 9x9.
struct NetworkShape {
  int width = 32;  // 16, 32 or 64

  int InputsOf(int layer) const { return layer == 0 ? kInputChannels : width; }
  int OutputsOf(int layer) const { return layer == kNetworkLayers - 1 ? kOutputChannels : width; }
  std::size_t WeightsOf(int layer) const {
    return std::size_t{9} * static_cast<std::size_t>(InputsOf(layer)) *
           static_cast<std::size_t>(OutputsOf(layer));
  }
  bool operator==(const NetworkShape&) const = default;
};

/// True for the widths that kernels exist for.
constexpr bool IsNetworkWidth(int width) { return width == 16 || width == 32 || width == 64; }

/// All parameters (also used for gradients and for the moments of an optimiser).
///
/// weights[layer] has shape [ky = 3][kx = 3][inputs][outputs], row-major: ky = 0 is the row north
/// of the output cell, kx = 0 the column west of it. biases[layer] has one value per output.
struct NetworkWeights {
  NetworkShape shape;
  std::array<std::vector<float>, kNetworkLayers> weights;
  std::array<std::vector<float>, kNetworkLayers> biases;
  bool operator==(const NetworkWeights&) const = default;
};

/// All zero.
NetworkWeights ZeroWeights(NetworkShape shape);

/// He initialisation (normal, variance 2 / fan-in) and zero biases, except for the last layer's:
/// these start at `output_bias`, the logit of the share of cells that people edit.
NetworkWeights InitialWeights(NetworkShape shape, std::uint64_t seed, float output_bias = -4.6F);

}  // namespace conav::nhpm
