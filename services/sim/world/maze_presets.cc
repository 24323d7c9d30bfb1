#include "sim/world/maze_presets.h"

#include <fmt/core.h>

#include <random>

namespace conav::sim {
namespace {

RandomMazeOptions Square(int size) {
  RandomMazeOptions options;
  options.height = size;
  options.width = size;
  return options;
}

/// With as many rooms for its area as 13 x 13 cells have.
RandomMazeOptions Large(int size, double extra_connection_probability = 0.0, bool simplify = true) {
  RandomMazeOptions options = Square(size);
  options.max_rooms = options.max_rooms * size * size / (13 * 13);
  options.retry_count *= options.max_rooms;
  options.extra_connection_probability = extra_connection_probability;
  options.simplify = simplify;
  return options;
}

RandomMazeOptions NineSmallRooms() {
  RandomMazeOptions options = Square(17);
  options.max_rooms = 9;
  options.room_max_size = 3;
  return options;
}

}  // namespace

const std::vector<MazePreset>& MazePresets() {
  static const std::vector<MazePreset> presets{
      {"conav13", "13 x 13 cells with the outer wall, four goals", Square(13), 4},
      {"conav13_inner", "13 x 13 cells inside of the outer wall, four goals", Square(15), 4},
      {"9x9", "MemoryMaze 9x9: 11 x 11 cells with the outer wall, three goals", Square(11), 3},
      {"11x11", "MemoryMaze 11x11: 13 x 13 cells with the outer wall, four goals", Square(13), 4},
      {"13x13", "MemoryMaze 13x13: 15 x 15 cells with the outer wall, five goals", Square(15), 5},
      {"15x15", "MemoryMaze 15x15: 17 x 17 cells with the outer wall, six goals", NineSmallRooms(),
       6},
      {"loop-free21", "21 x 21 cells with the outer wall, one way between two rooms", Large(21), 4},
      {"loop-free31", "31 x 31 cells with the outer wall, one way between two rooms", Large(31), 4},
      {"open21", "21 x 21 cells with the outer wall, many ways", Large(21, 0.3), 4},
      {"open31", "31 x 31 cells with the outer wall, many ways", Large(31, 0.3), 4},
      {"dead-ends21", "21 x 21 cells with the outer wall, corridors that end",
       Large(21, 0.0, false), 4},
  };
  return presets;
}

Result<MazePreset> FindMazePreset(std::string_view name) {
  constexpr std::string_view kPrefix = "memory_maze_";
  const std::string_view wanted =
      name.substr(0, kPrefix.size()) == kPrefix ? name.substr(kPrefix.size()) : name;
  std::string known;
  for (const MazePreset& preset : MazePresets()) {
    if (preset.name == wanted) return preset;
    known += (known.empty() ? "" : ", ") + preset.name;
  }
  return Fail(ErrorCode::kNotFound,
              fmt::format("maze preset \"{}\" is unknown; known presets: {}", name, known));
}

std::uint64_t MazeSeedFromPaperSeed(std::uint32_t paper_seed) {
  std::mt19937 engine(paper_seed);
  return engine() & 0x7fffffffU;
}

Grid<char> BlockVariations(const Grid<char>& entities) {
  constexpr int kBlocks = 3;
  const auto block_of = [](int index, int count) {
    int block = 0;
    while (block + 1 < kBlocks && index >= (block + 1) * count / kBlocks) ++block;
    return block;
  };
  Grid<char> variations = entities;
  for (std::size_t i = 0; i < entities.size(); ++i) {
    if (entities.values()[i] != kMazeWall) continue;
    const Cell cell = entities.CellAt(i);
    const int block =
        block_of(cell.row, entities.rows()) * kBlocks + block_of(cell.column, entities.columns());
    variations.values()[i] = static_cast<char>('0' + block);
  }
  return variations;
}

}  // namespace conav::sim
