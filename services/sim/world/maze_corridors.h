#pragma once

#include "common/runtime/random.h"
#include "sim/world/maze_rooms.h"

namespace conav::sim {

/// Stage 2: fills the space between the rooms with corridors, one region per connected rest of odd
/// cells, each a spanning tree made by a depth-first backtracker with two-cell steps.
void CarveCorridors(int first_region, Random& random, MazeDraft& draft);

}  // namespace conav::sim
