#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "nhpm/engine/kernels.h"

namespace conav::nhpm {

/// a * b + c, rounded once: for finite values the same bits as the processor's fused multiply-add,
/// on machines without one.
///
/// The product of two floats is exact as a double. Their sum with `c` is rounded to odd (S. Boldo
/// and G. Melquiond, "Emulation of FMA and correctly rounded sums: proved algorithms using rounding
/// to odd", IEEE Transactions on Computers 57(4), 2008), so that the conversion to float rounds as
/// if the sum were exact. Without branches, so compilers vectorise it.
inline float EmulatedFma(float a, float b, float c) {
  const double product = static_cast<double>(a) * static_cast<double>(b);
  const double addend = static_cast<double>(c);
  const double sum = product + addend;
  const double part = sum - product;
  const double error = (product - (sum - part)) + (addend - part);
  const auto bits = std::bit_cast<std::int64_t>(sum);
  const std::int64_t away_from_zero = (error > 0.0) == (sum > 0.0) ? 1 : -1;
  const bool nudge = error != 0.0 && (bits & 1) == 0;
  return static_cast<float>(std::bit_cast<double>(bits + (nudge ? away_from_zero : 0)));
}

/// The processor's own FMA where it is fast, else the emulation.
inline float ExactFma(float a, float b, float c) {
#ifdef __FP_FAST_FMAF
  return __builtin_fmaf(a, b, c);
#else
  return EmulatedFma(a, b, c);
#endif
}

}  // namespace conav::nhpm

/// The kernels as templates over an instruction set `V`, a struct with
///
///   Vector, kWidth              kWidth floats: 8 or 16
///   kTile                       how many cells fill the registers
///   Load(p), Broadcast(p)       from kWidth floats, from one
///   Store(p, v), Fma(a, b, c), Add(a, b), Zero(), Positive(v)  (max(v, 0))
///
/// and, for the last layer, Pair: kLanes floats for each of its two outputs, with PairZero(),
/// PairLoad(p) from 16 floats, PairRepeat(p) from 8 for both, PairFma(a, b, c) and
/// PairSum(p, v), which writes ((0+4) + (2+6)) + ((1+5) + (3+7)) of the lanes of each.
///
/// Included by one source file for each instruction set, with `V` in its anonymous namespace, so
/// that no instantiation is shared between files that are compiled for different processors.
namespace conav::nhpm {
namespace {

enum class Activation { kNone, kRelu };

/// The outputs that a tile computes at once: two vectors of them, or one if there are no more.
template <class V, int Outputs>
constexpr int kVectorsOfTile = Outputs >= 2 * V::kWidth ? 2 : 1;

/// Where the weights of output `o` begin, in blocks of 16 outputs, each [ky][kx][inputs][16].
template <int Inputs>
constexpr std::ptrdiff_t WeightsOfOutput(int o) {
  return std::ptrdiff_t{o / kBlock} * 9 * Inputs * kBlock + o % kBlock;
}

/// Computes some outputs of `P` cells.
template <class V, int P, int Inputs, int Outputs, Activation A>
inline void ConvolutionTile(const float* in, const std::int32_t* cells, std::int32_t stride,
                            const float* weights, const float* bias, float* out) {
  constexpr int kVectors = kVectorsOfTile<V, Outputs>;
  typename V::Vector sums[P][kVectors];
  const float* corner[P];
  for (int p = 0; p < P; ++p) {
    for (int v = 0; v < kVectors; ++v) sums[p][v] = V::Load(bias + v * V::kWidth);
    corner[p] = in + static_cast<std::ptrdiff_t>(cells[p] - stride - 1) * Inputs;
  }
  for (int ky = 0; ky < 3; ++ky) {
    for (int i = 0; i < 3 * Inputs; ++i) {  // the three cells of a row are contiguous
      typename V::Vector w[kVectors];
      for (int v = 0; v < kVectors; ++v) {
        w[v] = V::Load(weights + WeightsOfOutput<Inputs>(v * V::kWidth));
      }
      weights += kBlock;
      for (int p = 0; p < P; ++p) {
        const auto value = V::Broadcast(corner[p] + i);
        for (int v = 0; v < kVectors; ++v) sums[p][v] = V::Fma(value, w[v], sums[p][v]);
      }
    }
    for (int p = 0; p < P; ++p) corner[p] += static_cast<std::ptrdiff_t>(stride) * Inputs;
  }
  for (int p = 0; p < P; ++p) {
    float* target = out + static_cast<std::ptrdiff_t>(cells[p]) * Outputs;
    for (int v = 0; v < kVectors; ++v) {
      const auto value = A == Activation::kRelu ? V::Positive(sums[p][v]) : sums[p][v];
      V::Store(target + v * V::kWidth, value);
    }
  }
}

/// Calls `tile` with std::integral_constant<int, size>, sizes up to `Largest`, until all `cells`
/// are covered. Uses as few tiles as possible, of about equal size, because a small tile would wait
/// for its own sums.
template <int Largest, class Tile>
void ForEachTile(std::size_t cells, Tile&& tile) {
  if (cells == 0) return;
  const std::size_t tiles = (cells + Largest - 1) / Largest;
  const auto size = static_cast<int>(cells / tiles);
  const std::size_t larger = cells % tiles;  // tiles with one more cell
  const auto repeat = [&](int wanted, std::size_t times) {
    [&]<int... I>(std::integer_sequence<int, I...>) {
      const auto run = [&]<int P>(std::integral_constant<int, P> p) {
        for (std::size_t i = 0; P == wanted && i < times; ++i) tile(p);
      };
      (run(std::integral_constant<int, I + 1>()), ...);
    }
    (std::make_integer_sequence<int, Largest>());
  };
  if (larger > 0) repeat(size + 1, larger);
  repeat(size, tiles - larger);
}

template <class V, int Inputs, int Outputs, Activation A>
void Convolution(const float* in, const CellList& list, const float* weights, const float* bias,
                 float* out) {
  constexpr int kOutputsOfTile = kVectorsOfTile<V, Outputs> * V::kWidth;
  for (int o = 0; o < Outputs; o += kOutputsOfTile) {
    const std::int32_t* cell = list.cells.data();
    ForEachTile<V::kTile>(list.cells.size(), [&]<int P>(std::integral_constant<int, P>) {
      ConvolutionTile<V, P, Inputs, Outputs, A>(
          in, cell, list.stride, weights + WeightsOfOutput<Inputs>(o), bias + o, out + o);
      cell += P;
    });
  }
}

/// Weights of the last layer: [ky][kx][inputs / 8][kOutputChannels][8].
template <class V, int P, int Inputs>
inline void LastTile(const float* in, const std::int32_t* cells, std::int32_t stride,
                     const float* weights, const float* bias, float* out) {
  typename V::Pair sums[P];
  const float* corner[P];
  for (int p = 0; p < P; ++p) {
    sums[p] = V::PairZero();
    corner[p] = in + static_cast<std::ptrdiff_t>(cells[p] - stride - 1) * Inputs;
  }
  for (int ky = 0; ky < 3; ++ky) {
    for (int i = 0; i < 3 * Inputs; i += kLanes) {
      const auto w = V::PairLoad(weights);
      weights += kOutputChannels * kLanes;
      for (int p = 0; p < P; ++p) sums[p] = V::PairFma(V::PairRepeat(corner[p] + i), w, sums[p]);
    }
    for (int p = 0; p < P; ++p) corner[p] += static_cast<std::ptrdiff_t>(stride) * Inputs;
  }
  for (int p = 0; p < P; ++p) {
    float* target = out + static_cast<std::ptrdiff_t>(cells[p]) * kOutputChannels;
    V::PairSum(target, sums[p]);
    for (int o = 0; o < kOutputChannels; ++o) target[o] += bias[o];
  }
}

template <class V, int Inputs>
void Last(const float* in, const CellList& list, const float* weights, const float* bias,
          float* out) {
  const std::int32_t* cell = list.cells.data();
  ForEachTile<V::kTile>(list.cells.size(), [&]<int P>(std::integral_constant<int, P>) {
    LastTile<V, P, Inputs>(in, cell, list.stride, weights, bias, out);
    cell += P;
  });
}

/// Gradient of the weights from `I` inputs to some outputs, at one offset (ky, kx).
template <class V, int I, int Inputs, int Outputs>
inline void WeightGradientTile(const float* in, std::ptrdiff_t shift, const float* out_gradient,
                               const CellList& list, float* gradient) {
  constexpr int kVectors = kVectorsOfTile<V, Outputs>;
  typename V::Vector sums[I][kVectors];
  for (auto& row : sums) {
    for (auto& sum : row) sum = V::Zero();
  }
  for (const std::int32_t cell : list.cells) {
    const float* from = out_gradient + static_cast<std::ptrdiff_t>(cell) * Outputs;
    typename V::Vector g[kVectors];
    for (int v = 0; v < kVectors; ++v) g[v] = V::Load(from + v * V::kWidth);
    const float* values = in + (cell + shift) * Inputs;
    for (int i = 0; i < I; ++i) {
      const auto value = V::Broadcast(values + i);
      for (int v = 0; v < kVectors; ++v) sums[i][v] = V::Fma(value, g[v], sums[i][v]);
    }
  }
  for (int i = 0; i < I; ++i) {
    for (int v = 0; v < kVectors; ++v) {
      float* target = gradient + std::ptrdiff_t{i} * Outputs + v * V::kWidth;
      V::Store(target, V::Add(V::Load(target), sums[i][v]));
    }
  }
}

template <class V, int Inputs, int Outputs>
void WeightGradient(const float* in, const float* out_gradient, const CellList& list,
                    float* gradient) {
  constexpr int kInputsOfTile = 4;
  constexpr int kOutputsOfTile = kVectorsOfTile<V, Outputs> * V::kWidth;
  for (int k = 0; k < 9; ++k) {
    const std::ptrdiff_t shift = std::ptrdiff_t{k / 3 - 1} * list.stride + (k % 3 - 1);
    for (int i = 0; i < Inputs; i += kInputsOfTile) {
      for (int o = 0; o < Outputs; o += kOutputsOfTile) {
        WeightGradientTile<V, kInputsOfTile, Inputs, Outputs>(
            in + i, shift, out_gradient + o, list,
            gradient + (std::ptrdiff_t{k} * Inputs + i) * Outputs + o);
      }
    }
  }
}

/// The last layer's gradient: with only two outputs, lanes run over inputs.
template <class V, int Inputs>
void LastGradient(const float* in, const float* out_gradient, const CellList& list,
                  float* gradient) {
  constexpr int kVectors = kVectorsOfTile<V, Inputs>;
  constexpr int kInputsOfTile = kVectors * V::kWidth;
  for (int k = 0; k < 9; ++k) {
    const std::ptrdiff_t shift = std::ptrdiff_t{k / 3 - 1} * list.stride + (k % 3 - 1);
    for (int first = 0; first < Inputs; first += kInputsOfTile) {
      typename V::Vector sums[kOutputChannels][kVectors];
      for (auto& of_output : sums) {
        for (auto& sum : of_output) sum = V::Zero();
      }
      for (const std::int32_t cell : list.cells) {
        const float* values = in + (cell + shift) * Inputs + first;
        const float* from = out_gradient + static_cast<std::ptrdiff_t>(cell) * kOutputChannels;
        for (int v = 0; v < kVectors; ++v) {
          const auto value = V::Load(values + v * V::kWidth);
          for (int o = 0; o < kOutputChannels; ++o) {
            sums[o][v] = V::Fma(V::Broadcast(from + o), value, sums[o][v]);
          }
        }
      }
      float* target = gradient + (std::ptrdiff_t{k} * Inputs + first) * kOutputChannels;
      for (int o = 0; o < kOutputChannels; ++o) {
        float values[kInputsOfTile];
        for (int v = 0; v < kVectors; ++v) V::Store(values + v * V::kWidth, sums[o][v]);
        for (int i = 0; i < kInputsOfTile; ++i) target[i * kOutputChannels + o] += values[i];
      }
    }
  }
}

template <class V, int Width>
constexpr KernelSet MakeKernelSet(const char* name) {
  return {name,
          Width,
          Convolution<V, kInputChannels, Width, Activation::kRelu>,
          Convolution<V, Width, Width, Activation::kRelu>,
          Last<V, Width>,
          Convolution<V, kOutputChannels, Width, Activation::kNone>,
          Convolution<V, Width, Width, Activation::kNone>,
          WeightGradient<V, kInputChannels, Width>,
          WeightGradient<V, Width, Width>,
          LastGradient<V, Width>};
}

template <class V>
const KernelSet& KernelSetOf(int width, const char* name) {
  static const KernelSet sets[] = {MakeKernelSet<V, 16>(name), MakeKernelSet<V, 32>(name),
                                   MakeKernelSet<V, 64>(name)};
  return width == 16 ? sets[0] : width == 32 ? sets[1] : sets[2];
}

}  // namespace
}  // namespace conav::nhpm
