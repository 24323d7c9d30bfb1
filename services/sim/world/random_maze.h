#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/grid/grid.h"
#include "common/runtime/random.h"
#include "common/runtime/result.h"

namespace conav::sim {

/// The characters of a maze's entity layer.
inline constexpr char kMazeWall = '*';
inline constexpr char kMazeFree = ' ';
inline constexpr char kMazeSpawn = 'P';
inline constexpr char kMazeObject = 'G';
inline constexpr char kMazeVerticalDoor = 'H';    // the passage runs north-south
inline constexpr char kMazeHorizontalDoor = 'I';  // the passage runs west-east
/// Variation layer: cells outside of every room.
inline constexpr char kMazeNoVariation = '.';

/// Sizes are in cells and include the outer wall.
struct RandomMazeOptions {
  int height = 13;
  int width = 13;
  int max_rooms = 6;  // 0 = as many as fit
  /// An even room size counts as the odd size below it.
  int room_min_size = 3;
  int room_max_size = 5;
  int retry_count = 1000;  // failed placements before the generator stops trying
  double extra_connection_probability = 0.0;
  bool simplify = true;  // fill dead ends, straighten horseshoe bends
  bool has_doors = false;
  int max_variations = 26;
  int spawns_per_room = 1;
  int objects_per_room = 1;
  bool operator==(const RandomMazeOptions&) const = default;
};

inline constexpr int kMaxMazeSize = 501;

/// Names the first impossible option: an even or too small size, a room range that is empty or does
/// not fit, a negative count, a probability outside of [0, 1].
[[nodiscard]] Result<void> CheckMazeOptions(const RandomMazeOptions& options);

struct Maze {
  Grid<char> entities;
  Grid<char> variations;  // room k has letter 'A' + k mod max_variations
  int rooms = 0;
  bool operator==(const Maze&) const = default;
};

/// Random mazes of rooms and corridors, character for character those of DeepMind's labmaze (which
/// MemoryMaze and so the paper use) for the same options, seed and generation.
///
/// Stages of one generation: 1 rooms, 2 corridors, 3 connections, 4 simplification, 5 variations, 6
/// tokens, 7 links resolved. The random state carries over from one generation to the next.
class RandomMaze {
 public:
  /// Requires CheckMazeOptions(options).
  RandomMaze(const RandomMazeOptions& options, std::uint64_t seed);

  /// The next maze: the first call gives generation 1.
  Maze Generate();

 private:
  RandomMazeOptions options_;
  Random random_;
};

/// Generation `generation` (1, 2, ...) of the maze object with `seed`.
Maze GenerateMaze(const RandomMazeOptions& options, std::uint64_t seed, int generation);

/// One text row per grid row.
std::vector<std::string> ToLines(const Grid<char>& grid);

}  // namespace conav::sim
