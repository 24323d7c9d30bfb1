#pragma once

#include <array>
#include <vector>

#include "common/grid/grid.h"
#include "common/runtime/random.h"
#include "sim/world/random_maze.h"

namespace conav::sim {

/// A maze while it is being made.
struct MazeDraft {
  Grid<char> entities;
  /// Region of each carved cell: rooms are 1..n, corridors n+1 and on; 0 = nothing carved.
  Grid<int> regions;
};

/// Down, up, right, left: the order in which labmaze looks around (it decides what a draw means).
inline constexpr std::array<Cell, 4> kMazeDirections{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

/// Odd position, odd size.
struct MazeRoom {
  Cell north_west;
  int rows = 0;
  int columns = 0;
};

/// Stage 1: draws rooms until enough fit or too many did not, and shuffles them.
std::vector<MazeRoom> PlaceRooms(const RandomMazeOptions& options, Random& random);

/// Opens the rooms; room i becomes region i + 1.
void CarveRooms(const std::vector<MazeRoom>& rooms, MazeDraft& draft);

}  // namespace conav::sim
