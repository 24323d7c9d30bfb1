#include "sim/world/maze_presets.h"

#include <catch2/catch.hpp>

namespace conav::sim {
namespace {

struct PrintedLayout {
  std::string preset;
  std::uint32_t paper_seed;
  std::vector<std::string> lines;
};

// clang-format off
const std::vector<PrintedLayout>& PrintedLayouts() {
  static const std::vector<PrintedLayout> layouts{
      {"13x13", 234, {
        "***************",
        "*G  *  G    ***",
        "*   *P  * G ***",
        "*P      *P  ***",
        "* *** *** *****",
        "*             *",
        "* *********** *",
        "* ***   *     *",
        "* ***P G*  P* *",
        "* ***    G  * *",
        "* ***   *** * *",
        "* ***     *   *",
        "* ******* * PG*",
        "*         *   *",
        "***************",
      }},
      {"13x13", 666, {
        "***************",
        "*G        * P *",
        "* P * *** *   *",
        "*       *  G  *",
        "*** *   * *****",
        "*** * G *     *",
        "*** *P  * *** *",
        "*         P * *",
        "* * * ***   * *",
        "* *   *** G * *",
        "* *G P*** * * *",
        "* *   *   *P  *",
        "* ***** * *   *",
        "*       *    G*",
        "***************",
      }},
      {"13x13", 9, {
        "***************",
        "*             *",
        "*   * ******* *",
        "*PG     ***   *",
        "* ***   *** * *",
        "*    G P  P * *",
        "* *** ***   * *",
        "* *       G * *",
        "* * P   * * * *",
        "*   G     *  G*",
        "* * ***** * P *",
        "*    P*   *   *",
        "***   * *** ***",
        "***G        ***",
        "***************",
      }},
      {"11x11", 234, {
        "*************",
        "***  G*   ***",
        "***   *   ***",
        "*    P    ***",
        "* * ***P  ***",
        "*      G  ***",
        "*    P*** ***",
        "*    G    ***",
        "* * *** *****",
        "*     *    P*",
        "***  P* *   *",
        "***  G  * G *",
        "*************",
      }},
      {"11x11", 666, {
        "*************",
        "*       G   *",
        "* *****P  * *",
        "* * P     * *",
        "* *   *** * *",
        "*    G  P   *",
        "* * * *   * *",
        "*       G * *",
        "*   * *** * *",
        "*       G   *",
        "*P  *   P ***",
        "*  G*     ***",
        "*************",
      }},
      {"11x11", 9, {
        "*************",
        "***  G  *   *",
        "*** *P  *G  *",
        "*G        P *",
        "*   *   *** *",
        "* P *       *",
        "* * * * *** *",
        "*     *   * *",
        "* *   *P  * *",
        "* * PG   G* *",
        "* ******* * *",
        "*           *",
        "*************",
      }},
  };
  return layouts;
}
// clang-format on

TEST_CASE("the paper's seeds give the layouts of its first episodes", "[maze]") {
  CHECK(MazeSeedFromPaperSeed(234) == 133003720);
  for (const PrintedLayout& layout : PrintedLayouts()) {
    INFO(layout.preset << " paper seed " << layout.paper_seed);
    const MazePreset preset = FindMazePreset(layout.preset).value();
    const Maze maze = GenerateMaze(preset.options, MazeSeedFromPaperSeed(layout.paper_seed),
                                   kFirstEpisodeGeneration);
    CHECK(ToLines(maze.entities) == layout.lines);
  }
}

TEST_CASE("conav13 is MemoryMaze's 11x11 with its outer wall", "[maze]") {
  const MazePreset preset = FindMazePreset("conav13").value();
  CHECK(preset.options == FindMazePreset("11x11").value().options);
  CHECK(preset.options.height == 13);
  CHECK(preset.goals == 4);
  CHECK(FindMazePreset("conav13_inner").value().options.height == 15);
  CHECK(FindMazePreset("conav13_inner").value().goals == 4);
}

TEST_CASE("every preset can be generated, an unknown one is refused with their names", "[maze]") {
  const auto unknown = FindMazePreset("12x12");
  REQUIRE_FALSE(unknown);
  for (const MazePreset& preset : MazePresets()) {
    INFO(preset.name);
    REQUIRE(CheckMazeOptions(preset.options));
    CHECK(GenerateMaze(preset.options, 1, 1).rooms >= 1);
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
