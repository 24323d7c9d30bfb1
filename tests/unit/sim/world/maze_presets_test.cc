#include "sim/world/maze_presets.h"

#include <catch2/catch.hpp>
#include <fstream>

namespace conav::sim {
namespace {

TEST_CASE("the paper's seeds give the layouts of its first episodes", "[maze]") {
  CHECK(MazeSeedFromPaperSeed(234) == 133003720);
  std::ifstream file(CONAV_TESTS_DIR "/unit/sim/world/paper_layouts.txt");
  int count = 0;
  std::string preset;
  for (std::uint32_t paper_seed = 0; file >> preset >> paper_seed; ++count) {
    INFO(preset << " paper seed " << paper_seed);
    const Maze maze = GenerateMaze(FindMazePreset(preset).value().options,
                                   MazeSeedFromPaperSeed(paper_seed), kFirstEpisodeGeneration);
    for (const std::string& line : ToLines(maze.entities)) {
      std::string printed;
      std::getline(file >> std::ws, printed);
      CHECK(line == printed);
    }
  }
  CHECK(count == 6);
}

TEST_CASE("conav13 is MemoryMaze's 11x11 with its outer wall", "[maze]") {
  const MazePreset preset = FindMazePreset("conav13").value();
  CHECK(preset.options == FindMazePreset("11x11").value().options);
  CHECK(preset.options.height == 13);
  CHECK(preset.goals == 4);
  CHECK(FindMazePreset("conav13_inner").value().options.height == 15);
  CHECK(FindMazePreset("conav13_inner").value().goals == 4);
}

TEST_CASE("an unknown preset is refused with the names of all", "[maze]") {
  const auto unknown = FindMazePreset("12x12");
  REQUIRE_FALSE(unknown);
  for (const MazePreset& preset : MazePresets()) {
    CHECK_THAT(unknown.error().text, Catch::Contains(preset.name));
  }
}

TEST_CASE("walls are numbered by three by three blocks, other cells stay", "[maze]") {
  Grid<char> entities(7, 4, kMazeWall);  // blocks of 2, 2, 3 rows and 1, 1, 2 columns
  entities[{2, 2}] = kMazeSpawn;
  const std::vector<std::string> expected{"0122", "0122", "34P5", "3455", "6788", "6788", "6788"};
  CHECK(ToLines(BlockVariations(entities)) == expected);
}

}  // namespace
}  // namespace conav::sim
