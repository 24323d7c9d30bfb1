#pragma once

#include <cstddef>
#include <type_traits>

#include "nhpm/engine/kernels.h"

/// The kernels as templates over an instruction set `V`, a struct with
///
///   Vector                      8 floats
///   Load(p), Broadcast(p)       from 8 floats, from one
///   Store(p, v), Fma(a, b, c), Add(a, b), Positive(v)  (max(v, 0))
///   Sum(v)                      ((0+4) + (2+6)) + ((1+5) + (3+7)) of the lanes
///
/// Included by one source file for each instruction set, with `V` in its anonymous namespace, so
/// that no instantiation is shared between files that are compiled for different processors.
namespace conav::nhpm {
namespace {

constexpr int kBlock = 2 * kLanes;  // outputs that a tile computes at once

enum class Activation { kNone, kRelu };

/// Outputs [block, block + 16) of `P` cells. The weights of a block: [ky][kx][inputs][16].
template <class V, int P, int Inputs, int Outputs, Activation A>
inline void ConvolutionTile(const float* in, const std::int32_t* cells, std::int32_t stride,
                            const float* weights, const float* bias, float* out) {
  typename V::Vector low[P];
  typename V::Vector high[P];
  const float* corner[P];
  for (int p = 0; p < P; ++p) {
    low[p] = V::Load(bias);
    high[p] = V::Load(bias + kLanes);
    corner[p] = in + static_cast<std::ptrdiff_t>(cells[p] - stride - 1) * Inputs;
  }
  for (int ky = 0; ky < 3; ++ky) {
    for (int i = 0; i < 3 * Inputs; ++i) {  // the three cells of a row lie side by side
      const auto w_low = V::Load(weights);
      const auto w_high = V::Load(weights + kLanes);
      weights += kBlock;
      for (int p = 0; p < P; ++p) {
        const auto value = V::Broadcast(corner[p] + i);
        low[p] = V::Fma(value, w_low, low[p]);
        high[p] = V::Fma(value, w_high, high[p]);
      }
    }
    for (int p = 0; p < P; ++p) corner[p] += static_cast<std::ptrdiff_t>(stride) * Inputs;
  }
  for (int p = 0; p < P; ++p) {
    if constexpr (A == Activation::kRelu) {
      low[p] = V::Positive(low[p]);
      high[p] = V::Positive(high[p]);
    }
    float* target = out + static_cast<std::ptrdiff_t>(cells[p]) * Outputs;
    V::Store(target, low[p]);
    V::Store(target + kLanes, high[p]);
  }
}

/// How many tiles of which size cover a number of cells. Five and four cells keep the processor
/// busiest, six as much; smaller tiles wait for their own sums.
struct TilePlan {
  explicit TilePlan(std::ptrdiff_t cells) : fives(cells / 5), rest(static_cast<int>(cells % 5)) {
    if (rest == 4) {
      fours = 1;
    } else if (rest == 3 && fives >= 1) {
      fives -= 1;
      fours = 2;
    } else if (rest == 2 && fives >= 2) {
      fives -= 2;
      fours = 3;
    } else if (rest == 1 && fives >= 1) {
      fives -= 1;
      rest = 6;
      return;
    } else {
      return;
    }
    rest = 0;
  }
  std::ptrdiff_t fives;
  std::ptrdiff_t fours = 0;
  int rest;  // one tile of 1, 2, 3 or 6 cells, or none
};

template <class V, int Inputs, int Outputs, Activation A>
void Convolution(const float* in, const CellList& list, const float* weights, const float* bias,
                 float* out) {
  constexpr std::ptrdiff_t kWeightsOfBlock = std::ptrdiff_t{9} * Inputs * kBlock;
  const TilePlan plan(static_cast<std::ptrdiff_t>(list.cells.size()));
  for (int block = 0; block < Outputs; block += kBlock) {
    const std::int32_t* cell = list.cells.data();
    const auto tile = [&]<int P>(std::integral_constant<int, P>) {
      ConvolutionTile<V, P, Inputs, Outputs, A>(in, cell, list.stride, weights, bias + block,
                                                out + block);
      cell += P;
    };
    for (std::ptrdiff_t i = 0; i < plan.fives; ++i) tile(std::integral_constant<int, 5>());
    for (std::ptrdiff_t i = 0; i < plan.fours; ++i) tile(std::integral_constant<int, 4>());
    if (plan.rest == 6) tile(std::integral_constant<int, 6>());
    if (plan.rest == 3) tile(std::integral_constant<int, 3>());
    if (plan.rest == 2) tile(std::integral_constant<int, 2>());
    if (plan.rest == 1) tile(std::integral_constant<int, 1>());
    weights += kWeightsOfBlock;
  }
}

/// Weights of the last layer: [ky][kx][inputs / 8][kOutputChannels][8].
template <class V, int P, int Inputs>
inline void LastTile(const float* in, const std::int32_t* cells, std::int32_t stride,
                     const float* weights, const float* bias, float* out) {
  typename V::Vector sums[P][kOutputChannels];
  const float* corner[P];
  for (int p = 0; p < P; ++p) {
    for (int o = 0; o < kOutputChannels; ++o) sums[p][o] = V::Zero();
    corner[p] = in + static_cast<std::ptrdiff_t>(cells[p] - stride - 1) * Inputs;
  }
  for (int ky = 0; ky < 3; ++ky) {
    for (int i = 0; i < 3 * Inputs; i += kLanes) {
      const auto w_add = V::Load(weights);
      const auto w_remove = V::Load(weights + kLanes);
      weights += kOutputChannels * kLanes;
      for (int p = 0; p < P; ++p) {
        const auto values = V::Load(corner[p] + i);
        sums[p][0] = V::Fma(values, w_add, sums[p][0]);
        sums[p][1] = V::Fma(values, w_remove, sums[p][1]);
      }
    }
    for (int p = 0; p < P; ++p) corner[p] += static_cast<std::ptrdiff_t>(stride) * Inputs;
  }
  for (int p = 0; p < P; ++p) {
    float* target = out + static_cast<std::ptrdiff_t>(cells[p]) * kOutputChannels;
    for (int o = 0; o < kOutputChannels; ++o) target[o] = V::Sum(sums[p][o]) + bias[o];
  }
}

template <class V, int Inputs>
void Last(const float* in, const CellList& list, const float* weights, const float* bias,
          float* out) {
  const std::int32_t* cell = list.cells.data();
  auto left = static_cast<std::ptrdiff_t>(list.cells.size());
  for (; left >= 4; left -= 4, cell += 4) {
    LastTile<V, 4, Inputs>(in, cell, list.stride, weights, bias, out);
  }
  for (; left > 0; --left, ++cell) {
    LastTile<V, 1, Inputs>(in, cell, list.stride, weights, bias, out);
  }
}

/// Gradient of the weights from `I` inputs to 16 outputs, at one offset (ky, kx).
template <class V, int I, int Inputs, int Outputs>
inline void WeightGradientTile(const float* in, std::ptrdiff_t shift, const float* out_gradient,
                               const CellList& list, float* gradient) {
  typename V::Vector low[I];
  typename V::Vector high[I];
  for (int i = 0; i < I; ++i) low[i] = high[i] = V::Zero();
  for (const std::int32_t cell : list.cells) {
    const float* from = out_gradient + static_cast<std::ptrdiff_t>(cell) * Outputs;
    const auto g_low = V::Load(from);
    const auto g_high = V::Load(from + kLanes);
    const float* values = in + (cell + shift) * Inputs;
    for (int i = 0; i < I; ++i) {
      const auto value = V::Broadcast(values + i);
      low[i] = V::Fma(value, g_low, low[i]);
      high[i] = V::Fma(value, g_high, high[i]);
    }
  }
  for (int i = 0; i < I; ++i) {
    float* target = gradient + static_cast<std::ptrdiff_t>(i) * Outputs;
    V::Store(target, V::Add(V::Load(target), low[i]));
    V::Store(target + kLanes, V::Add(V::Load(target + kLanes), high[i]));
  }
}

template <class V, int Inputs, int Outputs>
void WeightGradient(const float* in, const float* out_gradient, const CellList& list,
                    float* gradient) {
  constexpr int kInputsOfTile = 4;
  for (int k = 0; k < 9; ++k) {
    const std::ptrdiff_t shift = std::ptrdiff_t{k / 3 - 1} * list.stride + (k % 3 - 1);
    for (int i = 0; i < Inputs; i += kInputsOfTile) {
      for (int block = 0; block < Outputs; block += kBlock) {
        WeightGradientTile<V, kInputsOfTile, Inputs, Outputs>(
            in + i, shift, out_gradient + block, list,
            gradient + (std::ptrdiff_t{k} * Inputs + i) * Outputs + block);
      }
    }
  }
}

/// The last layer's, with its few outputs: lanes run over 16 inputs.
template <class V, int Inputs>
void LastGradient(const float* in, const float* out_gradient, const CellList& list,
                  float* gradient) {
  for (int k = 0; k < 9; ++k) {
    const std::ptrdiff_t shift = std::ptrdiff_t{k / 3 - 1} * list.stride + (k % 3 - 1);
    for (int block = 0; block < Inputs; block += kBlock) {
      typename V::Vector sums[kOutputChannels][2];
      for (auto& sum : sums) sum[0] = sum[1] = V::Zero();
      for (const std::int32_t cell : list.cells) {
        const float* values = in + (cell + shift) * Inputs + block;
        const auto low = V::Load(values);
        const auto high = V::Load(values + kLanes);
        const float* from = out_gradient + static_cast<std::ptrdiff_t>(cell) * kOutputChannels;
        for (int o = 0; o < kOutputChannels; ++o) {
          const auto value = V::Broadcast(from + o);
          sums[o][0] = V::Fma(value, low, sums[o][0]);
          sums[o][1] = V::Fma(value, high, sums[o][1]);
        }
      }
      float* target = gradient + (std::ptrdiff_t{k} * Inputs + block) * kOutputChannels;
      for (int o = 0; o < kOutputChannels; ++o) {
        float values[kBlock];
        V::Store(values, sums[o][0]);
        V::Store(values + kLanes, sums[o][1]);
        for (int i = 0; i < kBlock; ++i) target[i * kOutputChannels + o] += values[i];
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

}  // namespace
}  // namespace conav::nhpm
