#include "sim/world/maze_corridors.h"

namespace conav::sim {
namespace {

/// One draw per carve, also when there is a single way on.
void CarveFrom(Cell start, int region, Random& random, MazeDraft& draft) {
  const auto carve = [&](Cell cell) {
    draft.entities[cell] = kMazeFree;
    draft.regions[cell] = region;
  };
  carve(start);
  std::vector<Cell> trail{start};
  while (!trail.empty()) {
    const Cell cell = trail.back();
    std::vector<Cell> ways;
    for (const Cell direction : kMazeDirections) {
      const Cell far = cell + direction + direction;
      if (draft.regions.Contains(far) && draft.regions[far] == 0) ways.push_back(direction);
    }
    if (ways.empty()) {
      trail.pop_back();
      continue;
    }
    const auto drawn = random.Uniform(0, static_cast<std::int64_t>(ways.size()) - 1);
    const Cell direction = ways[static_cast<std::size_t>(drawn)];
    carve(cell + direction);
    carve(cell + direction + direction);
    trail.push_back(cell + direction + direction);
  }
}

}  // namespace

void CarveCorridors(int first_region, Random& random, MazeDraft& draft) {
  int region = first_region;
  for (int row = 1; row < draft.regions.rows(); row += 2) {
    for (int column = 1; column < draft.regions.columns(); column += 2) {
      if (draft.regions[{row, column}] == 0) CarveFrom({row, column}, region++, random, draft);
    }
  }
}

}  // namespace conav::sim
