#pragma once

#include <vector>

#include "common/runtime/random.h"
#include "sim/world/maze_rooms.h"

namespace conav::sim {

/// Stage 5: a letter for each room's cells, also for those that simplification filled.
Grid<char> RoomVariations(const Grid<int>& regions, int rooms, const RandomMazeOptions& options);

/// Stage 6: puts `token` on `per_room` random free cells of each room, or on as many as there are.
void PlaceTokens(const std::vector<MazeRoom>& rooms, char token, int per_room, Random& random,
                 Grid<char>& entities);

}  // namespace conav::sim
