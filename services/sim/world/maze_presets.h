#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/result.h"
#include "sim/world/random_maze.h"

namespace conav::sim {

struct MazePreset {
  std::string name;
  std::string description;
  RandomMazeOptions options;
  int goals = 4;  // per robot
};

/// conav13 (default), conav13_inner, and MemoryMaze's 9x9, 11x11, 13x13, 15x15, whose names give
/// the size without the outer wall; larger ones for scenarios, whose names give it with the wall.
const std::vector<MazePreset>& MazePresets();

/// Also accepts "memory_maze_9x9" for "9x9". Errors: kNotFound, with the known names.
[[nodiscard]] Result<MazePreset> FindMazePreset(std::string_view name);

/// The seed that MemoryMaze gives to labmaze for the paper's seed S: the first output of
/// std::mt19937(S), without its highest bit.
std::uint64_t MazeSeedFromPaperSeed(std::uint32_t paper_seed);

/// The generation that MemoryMaze shows in its first episode (it discards the first one).
inline constexpr int kFirstEpisodeGeneration = 2;

/// Labels walls by region: the grid is cut into 3 x 3 blocks, and the walls of block b (row-major)
/// become digit '0' + b. All other characters stay.
Grid<char> BlockVariations(const Grid<char>& entities);

}  // namespace conav::sim
