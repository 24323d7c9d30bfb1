#pragma once

#include <cstdint>
#include <set>

#include "common/grid/grid.h"
#include "common/runtime/result.h"

namespace conav::sim {

struct MapCorruptionOptions {
  /// Wrong cells as a share of all cells, border included: round(0.12 * 13 * 13) = 20.
  double wrong_share = 0.12;
  /// Of the wrong cells, free in truth and drawn as walls; the others are walls left out.
  double false_wall_share = 0.5;
  /// How many spots attract errors, and how far they reach, in cells.
  int clusters = 3;
  double cluster_radius_cells = 2.0;
  /// Chance of a cell far from all spots, relative to one in the middle of a spot.
  double background = 0.15;
};

/// The operator's wrong map: the truth with exactly round(wrong_share * cells) cells turned over,
/// false_wall_share of them (rounded down) walls that are not there, the others walls that are
/// missing; where one kind runs out the other fills up. Errors cluster a little. Never changed:
/// `kept` cells (goals, starts), the border, and walls without a free neighbour, which nobody could
/// ever see. The same seed gives the same map.
///
/// False walls may cut off a goal on the operator's map; the operator may draw through walls.
/// Errors: kOutOfRange when there are not that many cells to turn over.
[[nodiscard]] Result<OccupancyGrid> CorruptMap(const OccupancyGrid& truth,
                                               const std::set<Cell>& kept,
                                               const MapCorruptionOptions& options,
                                               std::uint64_t seed);

}  // namespace conav::sim
