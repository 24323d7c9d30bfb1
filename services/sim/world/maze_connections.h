#pragma once

#include <vector>

#include "common/runtime/random.h"
#include "sim/world/maze_rooms.h"

namespace conav::sim {

/// Stands in the entity layer for an opening between two regions, until ResolveLinks.
inline constexpr char kMazeLinkMark = '\x01';

struct MazeLink {
  Cell cell;
  Cell direction;
};

/// Stage 3: opens one wall cell between each pair of touching regions, and further ones with the
/// extra probability unless next to another link. Returns the links in the order of their making.
std::vector<MazeLink> ConnectRegions(double extra_connection_probability, Random& random,
                                     MazeDraft& draft);

/// Stage 7: a link that simplification left with a wall behind it closes; the others become doors
/// or free cells.
void ResolveLinks(const std::vector<MazeLink>& links, bool has_doors, Grid<char>& entities);

}  // namespace conav::sim
