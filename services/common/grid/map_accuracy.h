#pragma once

#include <cmath>

#include "common/grid/grid.h"

namespace conav {

/// Accuracy of the operator's map.
struct MapAccuracy {
  int editable_cells = 0;  // all but the border
  int wrong_at_first = 0;  // wrong in the initial map
  int corrected = 0;       // of these, right now
  int broken = 0;          // right in the initial map, wrong now
  double mapping = 1.0;    // (corrected - broken) / wrong_at_first, at least 0
  double cell = 1.0;       // share of the editable cells that are right now
  bool operator==(const MapAccuracy&) const = default;
};

/// A cell counts as a wall from this probability on, and so does an unknown cell (0.5).
inline constexpr float kWallThreshold = 0.5F;

/// People take a map with cells of up to 1 m for a picture of its world, a raster, on which they
/// paint areas; with larger cells for a maze, which they change cell by cell.
inline bool IsRaster(double cell_size_m) { return cell_size_m <= 1.0; }

/// What people change at a time is taken to lie within a square of so many cells a side: one cell in
/// a maze, 10 m on a raster.
inline int EditSide(double cell_size_m) {
  constexpr double kRasterEditM = 10.0;
  return IsRaster(cell_size_m) ? static_cast<int>(std::lround(kRasterEditM / cell_size_m)) : 1;
}

/// Compares the operator's `belief` and initial map to the `truth`. If the initial map has no
/// error, `mapping` is 1 while nothing is broken, else 0. Border cells, and cells that are unknown
/// in the truth, do not count. All three have the same size (demanded). Source: paper section 6,
/// "final mapping accuracy" (never defined there).
MapAccuracy CompareMaps(const OccupancyGrid& truth, const OccupancyGrid& initial,
                        const BeliefGrid& belief);

/// The grid as a belief: wall 1, free 0, unknown 0.5.
BeliefGrid ToBelief(const OccupancyGrid& map);
/// The cells that the operator believes are walls; all others are free.
OccupancyGrid ToOccupancy(const BeliefGrid& belief);

}  // namespace conav
