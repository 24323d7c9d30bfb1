#include "sim/world/maze_tokens.h"

#include <algorithm>

namespace conav::sim {

Grid<char> RoomVariations(const Grid<int>& regions, int rooms, const RandomMazeOptions& options) {
  Grid<char> variations(regions.rows(), regions.columns(), kMazeNoVariation);
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const int region = regions.values()[i];
    if (region < 1 || region > rooms) continue;
    variations.values()[i] = static_cast<char>('A' + (region - 1) % options.max_variations);
  }
  return variations;
}

void PlaceTokens(const std::vector<MazeRoom>& rooms, char token, int per_room, Random& random,
                 Grid<char>& entities) {
  if (per_room <= 0) return;
  for (const MazeRoom& room : rooms) {
    std::vector<Cell> free_cells;
    for (int row = 0; row < room.rows; ++row) {
      for (int column = 0; column < room.columns; ++column) {
        const Cell cell = room.north_west + Cell{row, column};
        if (entities[cell] == kMazeFree) free_cells.push_back(cell);
      }
    }
    random.Shuffle(free_cells);
    const auto count = std::min(free_cells.size(), static_cast<std::size_t>(per_room));
    for (std::size_t i = 0; i < count; ++i) entities[free_cells[i]] = token;
  }
}

}  // namespace conav::sim
