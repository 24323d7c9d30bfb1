#pragma once

#include "common/runtime/random.h"
#include "nhpm/training/example.h"

namespace conav::nhpm {

/// Random maps and views. Where the view shows a wall that the map lacks it is added, where it shows
/// a wall of the map to be free this is removed: a rule that a network can learn without error.
inline ExampleSet MadeUpExamples(int rows, int columns, int count, std::uint64_t seed) {
  Random random(seed);
  ExampleSet set{rows, columns, std::vector<Example>(static_cast<std::size_t>(count))};
  for (Example& example : set.examples) {
    for (int cell = 0; cell < rows * columns; ++cell) {
      const int row = cell / columns;
      const int column = cell % columns;
      const bool inside = row > 0 && column > 0 && row < rows - 1 && column < columns - 1;
      const bool wall = random.Chance(0.4);
      const bool seen = random.Chance(0.3);
      const bool really_wall = random.Chance(0.4);
      example.input.insert(example.input.end(),
                           {wall ? 1.0F : 0.0F, random.Chance(0.2) ? 1.0F : 0.0F,
                            seen && !really_wall ? 1.0F : 0.0F, seen && really_wall ? 1.0F : 0.0F});
      const OutputLabel label =
          seen && really_wall != wall ? OutputLabel::kEdited : OutputLabel::kKept;
      example.labels.push_back(inside && !wall ? label : OutputLabel::kMasked);
      example.labels.push_back(inside && wall ? label : OutputLabel::kMasked);
    }
  }
  return set;
}

}  // namespace conav::nhpm
