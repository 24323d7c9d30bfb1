#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "nhpm/engine/packed_weights.h"
#include "nhpm/engine/padded_grid.h"

namespace conav::nhpm {

/// Forward passes for one grid size, whole or only where the input differs from a base.
///
/// An input cell reaches one cell further with each layer, 9x9 outputs in all; so after a base was
/// computed once, an input that differs from it in a few cells needs layer k only on these cells
/// grown by k. Exact: the bits are those of a full pass (kernels.h).
///
/// Inputs have shape [rows][columns][kInputChannels], logits [rows][columns][kOutputChannels].
/// Threads: one pass per thread; weights are shared.
class InferencePass {
 public:
  InferencePass(std::shared_ptr<const PackedWeights> weights, const KernelSet& kernels, int rows,
                int columns);

  int rows() const { return grid_.rows(); }
  int columns() const { return grid_.columns(); }

  /// Valid until the next call, as all results.
  std::span<const float> Full(std::span<const float> input);

  /// Computes `input` whole and keeps it.
  void SetBase(std::span<const float> input);
  bool has_base() const { return has_base_; }
  /// Requires has_base().
  std::span<const float> FromBase(std::span<const float> input);

  /// What activations and logits take, and a base once there is one.
  std::size_t bytes() const;

  /// Cells of hidden layers that the last call computed, and those of a full pass.
  std::size_t cells_computed() const { return cells_computed_; }
  std::size_t cells_of_full_pass() const { return (kNetworkLayers - 1) * grid_.size(); }

 private:
  /// One layer's output: as in the base, but for the cells in `dirty`.
  struct Layer {
    AlignedFloats base;  // empty before SetBase()
    AlignedFloats current;
    std::vector<std::int32_t> dirty;
    int channels = 0;
  };
  using Mask = std::vector<std::uint8_t>;  // per padded cell, 1 = in

  void Compute(std::size_t layer, const CellList& cells);
  void MarkDifferences(std::span<const float> input);
  void Grow();
  void ListMask();
  void Restore(Layer& layer) const;
  std::span<const float> Logits();

  std::shared_ptr<const PackedWeights> weights_;
  const KernelSet& kernels_;
  PaddedGrid grid_;
  bool has_base_ = false;
  AlignedFloats input_;  // padded
  std::vector<float> base_input_;
  std::array<Layer, kNetworkLayers> layers_;
  Mask inside_;
  Mask mask_;
  Mask grown_;
  std::vector<std::int32_t> list_;
  std::vector<float> logits_;
  std::size_t cells_computed_ = 0;
};

}  // namespace conav::nhpm
