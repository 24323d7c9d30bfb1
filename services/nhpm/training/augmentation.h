#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "nhpm/training/example.h"

namespace conav::nhpm {

/// The rotations and reflections that map a grid to itself: all 8 of the dihedral group D4 for a
/// square, 4 for other rectangles. A map that is turned is as good a map, and the person who edited
/// it would have edited the turned one alike.
///
/// Element e: bit 0 mirrors the rows, bit 1 the columns, bit 2 transposes first; 0 is the identity.
/// Source: paper Appendix B, "rotation 0/90/180/270, flip".
class GridSymmetries {
 public:
  GridSymmetries(int rows, int columns);

  int count() const { return count_; }
  /// Moves all channels and labels alike.
  void Apply(int element, const Example& from, Example& to) const;

 private:
  int count_ = 0;
  /// sources_[element][cell] = the cell that it takes its values from.
  std::array<std::vector<std::uint32_t>, 8> sources_;
};

}  // namespace conav::nhpm
