#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "nhpm/engine/aligned_floats.h"
#include "nhpm/engine/kernels.h"

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

}  // namespace conav::nhpm
