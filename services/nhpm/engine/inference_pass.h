#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "nhpm/engine/kernels.h"
#include "nhpm/engine/packed_weights.h"

namespace conav::nhpm {

/// The cells of a rows x columns grid as indices into its padded activations.
class PaddedGrid {
 public:
  PaddedGrid(int rows, int columns) : rows_(rows), columns_(columns) {
    cells_.reserve(size());
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) cells_.push_back(IndexOf(row, column));
    }
  }

  int rows() const { return rows_; }
  int columns() const { return columns_; }
  std::size_t size() const {
    return static_cast<std::size_t>(rows_) * static_cast<std::size_t>(columns_);
  }
  /// Cells of the padded grid, border included.
  std::size_t padded_size() const {
    return static_cast<std::size_t>(rows_ + 2) * static_cast<std::size_t>(columns_ + 2);
  }
  std::int32_t stride() const { return columns_ + 2; }
  std::int32_t IndexOf(int row, int column) const {
    return (row + 1) * (columns_ + 2) + column + 1;
  }

  /// All cells, row-major; a view that lives as long as the grid.
  CellList AllCells() const { return {cells_, stride()}; }

  /// Padded activations, all zero.
  AlignedFloats Activations(int channels) const {
    return AlignedFloats(padded_size() * static_cast<std::size_t>(channels), 0.0F);
  }

  /// Copies [rows][columns][channels] into padded activations.
  void Pad(int channels, std::span<const float> values, AlignedFloats& padded) const {
    const std::ptrdiff_t row_length = std::ptrdiff_t{columns_} * channels;
    for (int row = 0; row < rows_; ++row) {
      std::copy_n(values.begin() + row * row_length, row_length,
                  padded.begin() + std::ptrdiff_t{IndexOf(row, 0)} * channels);
    }
  }

  /// Copies padded activations into [rows][columns][channels].
  void Unpad(int channels, const AlignedFloats& padded, std::span<float> values) const {
    const std::ptrdiff_t row_length = std::ptrdiff_t{columns_} * channels;
    for (int row = 0; row < rows_; ++row) {
      std::copy_n(padded.begin() + std::ptrdiff_t{IndexOf(row, 0)} * channels, row_length,
                  values.begin() + row * row_length);
    }
  }

 private:
  int rows_;
  int columns_;
  std::vector<std::int32_t> cells_;
};

/// Forward passes for one grid size: a full pass, or only the part where the input differs from a
/// base.
///
/// An input cell influences one cell further with each layer, 9x9 outputs in all. So once a base is
/// computed, an input that differs from it in a few cells needs layer k only on these cells grown
/// by k. Exact: the bits are those of a full pass (kernels.h).
///
/// Inputs have shape [rows][columns][kInputChannels], logits [rows][columns][kOutputChannels].
/// Threads: one pass per thread; weights are shared.
class InferencePass {
 public:
  InferencePass(std::shared_ptr<const PackedWeights> weights, const KernelSet& kernels, int rows,
                int columns);

  int rows() const { return grid_.rows(); }
  int columns() const { return grid_.columns(); }

  /// Valid until the next call, like all results.
  std::span<const float> Full(std::span<const float> input);

  /// Computes `input` in full and keeps it.
  void SetBase(std::span<const float> input);
  bool has_base() const { return has_base_; }
  /// Requires has_base().
  std::span<const float> FromBase(std::span<const float> input);

  /// Memory of activations and logits, and of a base once there is one.
  std::size_t bytes() const;

 private:
  /// One layer's output: as in the base, except for the cells in `dirty`.
  struct Layer {
    AlignedFloats base;  // empty before SetBase()
    AlignedFloats current;
    std::vector<std::int32_t> dirty;
    int channels = 0;
  };
  using Mask = std::vector<std::uint8_t>;  // per padded cell, 1 = in the mask

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
};

}  // namespace conav::nhpm
