#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "nhpm/engine/network_weights.h"

/// The arithmetic of the network, once per instruction set, with equal bits from each.
///
/// Activations have shape [rows + 2][columns + 2][channels] with a border of zeros ("padded"). A
/// cell is an index into the padded grid, (row + 1) * (columns + 2) + column + 1. A kernel works on
/// any list of cells, so a full pass and a pass over a few changed cells are the same code, and the
/// value of a cell does not depend on which other cells are in the list:
///
///   out[cell][o] = bias[o] + sum over ky, kx, i in this order of in[cell + (ky, kx)][i] * w, by
///   fma
///
/// The last layer has 2 outputs, too few for the lanes of a vector. There 8 sums over inputs i = 0
/// .. 7 modulo 8 run in parallel and are added as a tree, the bias last.
namespace conav::nhpm {

inline constexpr int kLanes = 8;
inline constexpr int kBlock = 16;  // outputs whose weights are packed together

/// Where to compute: cells of a padded grid whose rows are `stride` cells apart.
struct CellList {
  std::span<const std::int32_t> cells;
  std::int32_t stride = 0;
};

/// `in` and `out` are padded activations; `weights` has the layout of PackedWeights.
using ConvolutionKernel = void (*)(const float* in, const CellList& cells, const float* weights,
                                   const float* bias, float* out);
/// Adds the gradient of a layer's weights, canonical order [ky][kx][inputs][outputs], to
/// `gradient`: sum over cells of in[cell + (ky, kx)][i] * out_gradient[cell][o].
using WeightGradientKernel = void (*)(const float* in, const float* out_gradient,
                                      const CellList& cells, float* gradient);

/// Kernels for one width. Channels: kInputChannels -> width -> width -> width -> kOutputChannels.
struct KernelSet {
  const char* name;
  int width;
  ConvolutionKernel first;   // with ReLU
  ConvolutionKernel hidden;  // with ReLU
  ConvolutionKernel last;    // logits
  /// d loss / d input of a layer, from the gradient of its output: convolutions with rotated
  /// weights, without bias and ReLU.
  ConvolutionKernel last_backward;    // kOutputChannels -> width
  ConvolutionKernel hidden_backward;  // width -> width
  WeightGradientKernel first_gradient;
  WeightGradientKernel hidden_gradient;
  WeightGradientKernel last_gradient;
};

enum class InstructionSet { kPortable, kAvx2, kAvx512 };

/// The instruction sets of this processor, best first; kPortable is always included.
std::vector<InstructionSet> AvailableInstructionSets();

/// Demands width 16, 32 or 64, and an available `set`.
const KernelSet& KernelsFor(int width, InstructionSet set);
/// The best available.
const KernelSet& KernelsFor(int width);

/// The kernels of each instruction set, compiled with its own flags; `width` as in KernelsFor().
const KernelSet& PortableKernels(int width);
const KernelSet& Avx2Kernels(int width);
const KernelSet& Avx512Kernels(int width);

}  // namespace conav::nhpm
