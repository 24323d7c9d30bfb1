#pragma once

#include <cstdint>
#include <set>

#include "common/grid/grid.h"
#include "common/runtime/result.h"

namespace conav::sim {

struct MapCorruptionOptions {
  /// Wrong cells as a share of all cells, border included: round(0.12 * 13 * 13) = 20.
  double wrong_share = 0.12;
  /// Share of the wrong cells that are false walls (free in truth); the rest are missing walls.
  double false_wall_share = 0.5;
  /// How many spots attract errors, and how far they reach, in cells.
  int clusters = 3;
  double cluster_radius_cells = 2.0;
  /// Weight of a cell far from all spots, relative to one in the middle of a spot.
  double background = 0.15;
};

/// The operator's wrong map: the truth with exactly round(wrong_share * cells) cells flipped.
/// false_wall_share of them (rounded down) are false walls, the others missing walls; if one kind
/// runs out, the other fills up. Errors cluster a little. Never changed: `kept` cells (goals,
/// starts), the border, and walls without a free neighbour, which no robot could ever see. The same
/// seed gives the same map.
///
/// False walls may cut off a goal on the operator's map; the operator may draw through walls.
/// Errors: kOutOfRange when there are too few cells to flip.
[[nodiscard]] Result<OccupancyGrid> CorruptMap(const OccupancyGrid& truth,
                                               const std::set<Cell>& kept,
                                               const MapCorruptionOptions& options,
                                               std::uint64_t seed);

/// An operator's outdated map of open terrain: in pieces, channels have silted up (free in truth,
/// occupied on the map) or opened (the other way round). Exactly round(wrong_share * free cells)
/// cells are wrong, false_wall_share of them (rounded down) silted up; if one kind runs out, the
/// other fills up. A piece is connected, begins at a shore if it is opened, and has at least
/// kSmallestPiece cells, but for the last one. Cells with `kept` 1 and the border are right.
/// Integers only: the same seed gives the same map on every machine. Other options are ignored.
/// Errors: kOutOfRange when there are too few cells to change.
[[nodiscard]] Result<OccupancyGrid> SiltMap(const OccupancyGrid& truth,
                                            const Grid<std::uint8_t>& kept,
                                            const MapCorruptionOptions& options,
                                            std::uint64_t seed);

inline constexpr int kSmallestPiece = 12;

}  // namespace conav::sim
