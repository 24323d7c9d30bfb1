#pragma once

#include "common/grid/grid.h"

namespace conav {

/// How right the operator's map is.
struct MapAccuracy {
  int editable_cells = 0;  // all but the border
  int wrong_at_first = 0;  // wrong in the initial map
  int corrected = 0;       // of these, right now
  int broken = 0;          // right in the initial map, wrong now
  double mapping = 1.0;    // (corrected - broken) / wrong_at_first, at least 0
  double cell = 1.0;       // share of the editable cells that are right now
  bool operator==(const MapAccuracy&) const = default;
};

/// A cell counts as a wall from probability 0.5 on, an unknown one so too.
inline constexpr float kWallThreshold = 0.5F;

/// Compares the operator's `belief` and the map it began with to the `truth`. `mapping` is 1 when
/// the initial map had no error and nothing was broken since, 0 when something was. Border cells,
/// and cells that are unknown in the truth, do not count. All three have the same size (demanded).
/// Source: paper section 6, "final mapping accuracy" (never defined there).
MapAccuracy CompareMaps(const OccupancyGrid& truth, const OccupancyGrid& initial,
                        const BeliefGrid& belief);

/// The grid as a belief: wall 1, free 0, unknown 0.5.
BeliefGrid ToBelief(const OccupancyGrid& map);
/// What the operator takes for walls; all else is free.
OccupancyGrid ToOccupancy(const BeliefGrid& belief);

}  // namespace conav
