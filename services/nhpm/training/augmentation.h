#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/runtime/random.h"
#include "nhpm/model/canvas_placement.h"
#include "nhpm/training/example.h"

// One user: batch passes; augmentation is looked for by name.

namespace conav::nhpm {

/// Makes equally valid variants of an example, so that a network learns from more of them. Variants
/// are numbers: what they mean is the augmentation's own matter. Threads: safe to call concurrently.
class Augmentation {
 public:
  virtual ~Augmentation() = default;

  /// Shape of the variants.
  virtual int rows() const = 0;
  virtual int columns() const = 0;
  /// A random variant, for training.
  virtual std::uint64_t Draw(Random& random) const = 0;
  /// The variant in which a validation or test example is always measured.
  virtual std::uint64_t FixedVariant(std::size_t index) const = 0;
  /// Transforms all channels and labels alike.
  virtual void Apply(std::uint64_t variant, const Example& from, Example& to) const = 0;
};

/// The rotations and reflections that map a grid to itself: all 8 of the dihedral group D4 for a
/// square, 4 for other rectangles. A turned map is an equally valid example: its person would have
/// made the turned edits.
///
/// Element e: bit 0 mirrors the rows, bit 1 the columns, bit 2 transposes first; 0 is the identity,
/// also the fixed variant. Camera and heading stay as they are: the network does not see them.
/// Source: paper Appendix B, "rotation 0/90/180/270, flip".
class GridSymmetries final : public Augmentation {
 public:
  GridSymmetries(int rows, int columns);

  int count() const { return count_; }
  int rows() const override { return rows_; }
  int columns() const override { return columns_; }
  std::uint64_t Draw(Random& random) const override;
  std::uint64_t FixedVariant(std::size_t /*index*/) const override { return 0; }
  void Apply(std::uint64_t element, const Example& from, Example& to) const override;

 private:
  int rows_;
  int columns_;
  int count_ = 0;
  /// sources_[element][cell] = the source cell of its values.
  std::array<std::vector<std::uint32_t>, 8> sources_;
};

/// Maze maps pasted on a canvas (DrawPlacement); a variant is the seed of its placement. The input is
/// what EncodeInput makes of the pasted query (CanvasMap::Paste). Outside of the map there are walls,
/// and outputs are masked there, as on the canvas's border and the map's.
/// Source: paper section 6.3; it does not say what is outside.
class CanvasAugmentation final : public Augmentation {
 public:
  /// Examples with all inputs (InputSelection).
  CanvasAugmentation(int canvas, int map_rows, int map_columns)
      : canvas_(canvas), map_rows_(map_rows), map_columns_(map_columns) {}

  int rows() const override { return canvas_; }
  int columns() const override { return canvas_; }
  std::uint64_t Draw(Random& random) const override { return random.Next(); }
  std::uint64_t FixedVariant(std::size_t index) const override;
  void Apply(std::uint64_t seed, const Example& from, Example& to) const override;

 private:
  int canvas_;
  int map_rows_;
  int map_columns_;
};

}  // namespace conav::nhpm
