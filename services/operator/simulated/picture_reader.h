#pragma once

#include <cstdint>
#include <set>
#include <vector>

#include "common/protocol/robot.h"
#include "common/protocol/supervision.h"
#include "common/runtime/random.h"
#include "operator/simulated/picture_reading.h"

namespace conav::operators {

/// Looks at a picture as people were seen to do, and says which cells of the map they would change:
/// a SYNTHETIC annotator, not a model fitted to data.
///
/// It compares the cells that the picture shows, and the cells that the robot drove through, with
/// the belief. Never edits the border, and never puts a wall where a robot has been.
/// Source:  paper section 6.1 (qualitative), 6.3.
/// Seeded:  equal seeds and equal sequences of pictures and beliefs give equal edits.
class PictureReader {
 public:
  PictureReader(const PictureReaderParameters& parameters, std::uint64_t seed);

  /// Edits in row-major order, each cell once, each a change of `belief`. Cells of the picture
  /// outside of the belief are ignored. `certain` cells are left as they are.
  std::vector<CellEdit> Read(const BeliefGrid& belief, const Picture& picture,
                             const std::set<Cell>& certain);

  /// One draw of this reader's random numbers: is a picture of a stream looked at?
  bool Glances(double rate) { return random_.Chance(rate); }

 private:
  PictureReaderParameters parameters_;
  Random random_;
};

}  // namespace conav::operators
