#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace conav::nhpm {

inline constexpr int kNetworkLayers = 4;
inline constexpr int kInputChannels = 4;
inline constexpr int kOutputChannels = 2;

/// The two networks of paper Appendix B, of 3x3 convolutions with zero padding 1 and a ReLU after
/// each but the last.
enum class Architecture : std::uint8_t {
  /// For mazes: 4 convolutions (kNetworkLayers), stride 1; inputs -> width -> width -> width ->
  /// outputs. Receptive field 9x9. Widths 16, 32 and 64.
  kConvolutional,
  /// For rasters: 6 + 1 + 6 convolutions (encoder_decoder.h). The widths of its three levels are
  /// width, 2 width and 4 width; the paper's bottleneck of 64 channels has width 16. Widths 4, 8,
  /// 16 and 32.
  kEncoderDecoder,
};

inline constexpr int kEncoderDecoderLayers = 13;

struct NetworkShape {
  int width = 32;
  Architecture architecture = Architecture::kConvolutional;

  int layers() const {
    return architecture == Architecture::kConvolutional ? kNetworkLayers : kEncoderDecoderLayers;
  }
  int InputsOf(int layer) const { return layer == 0 ? kInputChannels : OutputsOf(layer - 1); }
  int OutputsOf(int layer) const {
    constexpr int kWidths[] = {1, 1, 2, 2, 4, 4, 4, 4, 2, 2, 1, 1};  // of the encoder-decoder
    if (layer == layers() - 1) return kOutputChannels;
    return architecture == Architecture::kConvolutional ? width : kWidths[layer] * width;
  }
  std::size_t WeightsOf(int layer) const {
    return std::size_t{9} * static_cast<std::size_t>(InputsOf(layer)) *
           static_cast<std::size_t>(OutputsOf(layer));
  }
  bool operator==(const NetworkShape&) const = default;
};

/// True for the widths that the architecture has.
constexpr bool IsNetworkWidth(int width, Architecture architecture = Architecture::kConvolutional) {
  if (architecture == Architecture::kConvolutional) {
    return width == 16 || width == 32 || width == 64;
  }
  return width == 4 || width == 8 || width == 16 || width == 32;
}

/// All parameters (also used for gradients and for the moments of an optimiser), layer by layer.
///
/// weights[layer] has shape [ky = 3][kx = 3][inputs][outputs], row-major: ky = 0 is the row north
/// of the output cell, kx = 0 the column west of it. biases[layer] has one value per output.
struct NetworkWeights {
  NetworkShape shape;
  std::vector<std::vector<float>> weights;
  std::vector<std::vector<float>> biases;
  bool operator==(const NetworkWeights&) const = default;
};

/// All zero.
NetworkWeights ZeroWeights(NetworkShape shape);

/// He initialisation (normal, variance 2 / fan-in) and zero biases, except for the last layer's:
/// these start at `output_bias`, the logit of the share of cells that people edit.
NetworkWeights InitialWeights(NetworkShape shape, std::uint64_t seed, float output_bias = -4.6F);

}  // namespace conav::nhpm
