#pragma once

#include <array>
#include <cstddef>
#include <new>
#include <vector>

#include "nhpm/engine/network_weights.h"

namespace conav::nhpm {

/// Allocates on cache-line borders, so that no vector load crosses two lines.
template <class T>
struct AlignedAllocator {
  using value_type = T;
  static constexpr std::align_val_t kAlignment{64};

  AlignedAllocator() = default;
  template <class U>
  AlignedAllocator(const AlignedAllocator<U>&) {}  // NOLINT: allocators convert

  T* allocate(std::size_t count) {
    return static_cast<T*>(::operator new(count * sizeof(T), kAlignment));
  }
  void deallocate(T* memory, std::size_t) { ::operator delete(memory, kAlignment); }
  bool operator==(const AlignedAllocator&) const { return true; }
};

using AlignedFloats = std::vector<float, AlignedAllocator<float>>;

/// Parameters in the order in which the kernels read them, so that a tile walks through them once:
///
///   layers 0, 1, 2   blocks of 16 outputs, each [ky][kx][inputs][16]
///   layer 3          [ky][kx][inputs / 8][kOutputChannels][8]
///   backward         of layers 1, 2, 3: blocks of 16 INPUTS, each [2-ky][2-kx][outputs][16]
struct PackedWeights {
  /// kInference leaves out the backward weights.
  enum class Use { kInference, kTraining };

  PackedWeights(const NetworkWeights& weights, Use use);
  /// Sets new values of the same shape.
  void Assign(const NetworkWeights& weights);

  NetworkShape shape;
  std::array<AlignedFloats, kNetworkLayers> forward;
  std::array<AlignedFloats, kNetworkLayers> backward;  // [0] stays empty
  std::array<std::vector<float>, kNetworkLayers> biases;
};

}  // namespace conav::nhpm
