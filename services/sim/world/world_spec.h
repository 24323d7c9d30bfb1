#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "common/grid/grid.h"
#include "common/runtime/random.h"
#include "common/runtime/result.h"

namespace conav::sim {

/// The largest connected free area; the northernmost one when several are as large. Empty when no
/// cell is free.
std::set<Cell> LargestFreeArea(const OccupancyGrid& truth);

/// Hands out cells, each once: the preferred ones first, in random order, then the others.
class CellDeck {
 public:
  CellDeck(std::vector<Cell> preferred, const std::set<Cell>& all, Random& random);

  /// The next cell that is not in `taken`, which it then is. Errors: kOutOfRange when none is left.
  [[nodiscard]] Result<Cell> Draw(std::set<Cell>& taken);

 private:
  std::vector<Cell> cells_;  // the next one last
};

/// What a world is made from; the sim's config fills it in.
struct WorldOptions {
  /// A seed S makes the maze that the paper's seed S makes (MemoryMaze's mapping, first episode).
  std::uint64_t seed = 1;
  std::string preset = "conav13";
  /// When set, the world is this ROS map_server map and not a maze.
  std::filesystem::path map_yaml;
  /// The operator's outdated plan of it; empty = the truth, corrupted like a maze's.
  std::filesystem::path operator_map_yaml;
  double cell_size_m = 2.0;      // of a map file's navigation cells
  double occupied_share = 0.25;  // a cell with more occupied pixels than this is a wall
  int robots = 1;
  int goals_per_robot = 0;  // 0 = the preset's number
  bool shared_goals = false;
  std::vector<Cell> starts;       // one per robot; empty = drawn
  std::vector<Cell> goals;        // of every robot; empty = goals_per_robot are drawn for each
  double wrong_share = 0.12;      // of all cells, wrong on the initial human map (docs/paper.md)
  double false_wall_share = 0.5;  // of the wrong cells, free in truth and drawn as walls
  /// 0, 90, 180 or 270, counter-clockwise; the whole world is turned when it is complete, given
  /// starts and goals with it.
  int rotation_deg = 0;
};

/// A world, complete for one seed: the truth, who starts where with which goals, and what the
/// operator believes.
struct WorldSpec {
  OccupancyGrid truth;       // no unknown cells, border occupied
  OccupancyGrid human_map;   // the operator's initial map, as large as the truth
  Grid<char> wall_classes;   // which texture each wall cell has
  Grid<char> floor_classes;  // '.' corridor, letters rooms
  double cell_size_m = 2.0;
  std::vector<Cell> starts;        // per robot, distinct
  double start_heading_rad = 0.0;  // of every robot
  std::vector<std::vector<Cell>>
      goals;  // per robot; equal lists when shared. All reachable from the start.
  bool shared_goals = false;
};

/// Builds a world. Starts are drawn from the maze's P cells first, goals from its G cells first,
/// then both from the other free cells; drawn goals are different for each robot unless shared. A
/// maze with fewer G cells than its preset has goals is made again, as MemoryMaze does. On a map
/// file, starts and goals are drawn from the largest connected free area. Maze, starts, goals and
/// corruption have independent random sources, so that robot 1 is the same in a world with more
/// robots.
///
/// Errors: kNotFound (preset), those of LoadMapPair (map file; names file and key), kOutOfRange
/// (too many robots or goals for the free cells, wrong_share, rotation_deg), kInvalidArgument (given starts or
/// goals that are walls, equal, too few, or that the robot cannot reach; a given start on a given
/// goal).
[[nodiscard]] Result<WorldSpec> MakeWorldSpec(const WorldOptions& options);

/// The same world seen by somebody who stands turned: truth, operator's map, textures, starts, goals
/// and the robots' first heading, all turned counter-clockwise around the middle. Rows and columns
/// change places at 90 and 270 degrees. Paper, section 6.2: layouts are used again, rotated.
/// Errors: kOutOfRange when `rotation_deg` is not 0, 90, 180 or 270.
[[nodiscard]] Result<WorldSpec> Rotated(WorldSpec spec, int rotation_deg);

}  // namespace conav::sim
