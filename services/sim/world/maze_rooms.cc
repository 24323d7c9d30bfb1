#include "sim/world/maze_rooms.h"

#include <algorithm>

namespace conav::sim {
namespace {

/// Draws only when there is a choice.
int DrawBetween(int low, int high, Random& random) {
  return low < high ? static_cast<int>(random.Uniform(low, high)) : low;
}

/// Works on the half-resolution grid of odd cells, so that rooms never touch.
MazeRoom DrawRoom(const RandomMazeOptions& options, Random& random) {
  const int half_rows = (options.height - 1) / 2;
  const int half_columns = (options.width - 1) / 2;
  const int low = (options.room_min_size - 1) / 2;
  const int high = (options.room_max_size - 1) / 2;
  const int middle = (low + high) / 2;
  int width = DrawBetween(low, middle, random);
  int height = DrawBetween(low, middle, random);
  int& long_side = DrawBetween(0, 1, random) == 0 ? width : height;
  long_side += DrawBetween(middle, high, random) - middle;
  const int row = DrawBetween(0, half_rows - height - 1, random);
  const int column = DrawBetween(0, half_columns - width - 1, random);
  return {{2 * row + 1, 2 * column + 1}, 2 * height + 1, 2 * width + 1};
}

bool Overlap(const MazeRoom& a, const MazeRoom& b) {
  return a.north_west.row < b.north_west.row + b.rows &&
         b.north_west.row < a.north_west.row + a.rows &&
         a.north_west.column < b.north_west.column + b.columns &&
         b.north_west.column < a.north_west.column + a.columns;
}

}  // namespace

std::vector<MazeRoom> PlaceRooms(const RandomMazeOptions& options, Random& random) {
  std::vector<MazeRoom> rooms;
  int failures = 0;
  int covered = 0;
  const auto more_wanted = [&] {
    return options.max_rooms == 0 || static_cast<int>(rooms.size()) < options.max_rooms;
  };
  while (failures < options.retry_count && covered < options.height * options.width &&
         more_wanted()) {
    const MazeRoom room = DrawRoom(options, random);
    if (std::any_of(rooms.begin(), rooms.end(),
                    [&](const MazeRoom& other) { return Overlap(room, other); })) {
      ++failures;
      continue;
    }
    covered += room.rows * room.columns;
    rooms.push_back(room);
  }
  random.Shuffle(rooms);
  return rooms;
}

void CarveRooms(const std::vector<MazeRoom>& rooms, MazeDraft& draft) {
  int region = 0;
  for (const MazeRoom& room : rooms) {
    ++region;
    for (int row = 0; row < room.rows; ++row) {
      for (int column = 0; column < room.columns; ++column) {
        const Cell cell = room.north_west + Cell{row, column};
        draft.entities[cell] = kMazeFree;
        draft.regions[cell] = region;
      }
    }
  }
}

}  // namespace conav::sim
