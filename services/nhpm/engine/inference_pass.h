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
/// by k. Exact: the bits are those of a full pass (kernels.h). Costs what changed, not what the
/// grid holds.
///
/// Inputs have shape [rows][columns][kInputChannels], logits [rows][columns][kOutputChannels].
/// Threads: one pass per thread; weights are shared.
class InferencePass {
 public:
  InferencePass(std::shared_ptr<const PackedWeights> weights, const KernelSet& kernels, int rows,
                int columns);

  int rows() const { return grid_.rows(); }
  int columns() const { return grid_.columns(); }

  /// The logits of `input`, valid until the next call, like all results. Drops changes.
  std::span<const float> Full(std::span<const float> input);

  /// Computes `input` in full and keeps it.
  std::span<const float> SetBase(std::span<const float> input);
  bool has_base() const { return has_base_; }

  /// The next pass is about the base with this value in it. Requires has_base().
  void Change(int row, int column, int channel, float value);
  /// A cell and its logits.
  struct Computed {
    int row = 0;
    int column = 0;
    const float* logits = nullptr;
  };
  /// Computes the base with the changes, which end with this. Returns each cell that was computed:
  /// all whose logits can differ from the base's, at most 4 cells from a change.
  std::span<const Computed> FromBase();
  /// The same; the base with the changes is the base from now on.
  std::span<const Computed> MoveBase();

  /// All logits of the newest pass.
  std::span<const float> Logits();

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

  void Compute(std::size_t layer, const CellList& cells);
  void ComputeChanged();
  void Reach(std::int32_t cell) {
    std::uint8_t& may_reach = may_reach_[static_cast<std::size_t>(cell)];
    if (may_reach != 0) reached_.push_back(cell);
    may_reach = 0;
  }
  void ReachNeighbours(std::size_t first);
  void Restore(Layer& layer) const;
  std::span<const Computed> ComputedCells();

  std::shared_ptr<const PackedWeights> weights_;
  const KernelSet& kernels_;
  PaddedGrid grid_;
  bool has_base_ = false;
  AlignedFloats input_;  // padded
  AlignedFloats base_input_;
  std::vector<std::int32_t> changes_;  // cells of input_ that may differ from base_input_
  std::array<Layer, kNetworkLayers> layers_;
  std::vector<std::int32_t> reached_;    // by the changes, layer by layer
  std::vector<std::uint8_t> may_reach_;  // per padded cell: 1 inside, unless it is in reached_
  std::vector<Computed> computed_;
  std::vector<float> logits_;
};

}  // namespace conav::nhpm
