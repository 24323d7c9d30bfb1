#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/grid/grid.h"
#include "common/grid/wing.h"
#include "common/runtime/result.h"

namespace conav::sim {

/// The preset that is a waterway (MakeTerrain) and not a maze.
inline constexpr std::string_view kWaterwayPreset = "waterway";

/// Kept free around a robot in open terrain, besides its radius.
inline constexpr double kOpenMarginM = 0.05;

inline constexpr double kMinRobotRadiusM = 0.05;
inline constexpr double kMaxRobotRadiusM = 2.0;

/// An image as a height map: what is lower than the water level is water, the rest land.
struct HeightMapOptions {
  /// A PNG or TIFF with one channel of 8 or 16 bits; empty = none.
  std::filesystem::path image;
  /// In pixel values.
  double water_level = 128.0;
  /// Side of a pixel, in metres.
  double resolution_m = 1.0;
};

/// The options of a world; the sim's config fills them in.
struct WorldOptions {
  /// Seed S gives the maze of the paper's seed S (MemoryMaze's mapping, first episode).
  std::uint64_t seed = 1;
  /// A maze's, or kWaterwayPreset.
  std::string preset = "conav13";
  /// When set, the world is this ROS map_server map and not a maze.
  std::filesystem::path map_yaml;
  /// When it has an image, the world is that one. It is open.
  HeightMapOptions height_map;
  /// The operator's outdated plan of the building; empty = the truth, corrupted like a maze's.
  std::filesystem::path operator_map_yaml;
  double cell_size_m = 2.0;      // of a map file's navigation cells
  double occupied_share = 0.25;  // a cell with more occupied pixels than this is a wall
  /// Of the waterway; MakeTerrain gives the limits.
  int terrain_rows = 150;
  int terrain_columns = 150;
  double terrain_cell_size_m = 1.0;
  /// Robots drive anywhere on a map, not from cell to cell. Waterways and height maps are open.
  bool open = false;
  double robot_radius_m = 0.2;  // in open terrain
  int robots = 1;
  int goals_per_robot = 0;  // 0 = the preset's number
  bool shared_goals = false;
  std::vector<Cell> starts;  // one per robot; empty = drawn
  std::vector<Cell> goals;   // of every robot; empty = goals_per_robot are drawn for each
  /// Wrong on the initial human map (docs/paper.md); of all cells, in open terrain of the free ones.
  double wrong_share = 0.12;
  double false_wall_share = 0.5;  // of the wrong cells, free in truth and drawn as walls
  /// Of a maze: a wing of the initial human map, drawn with the seed, is wrong as a whole besides.
  WingError wing_error = WingError::kNone;
  /// 0, 90, 180 or 270, counter-clockwise; turns the completed world, including given starts and
  /// goals.
  int rotation_deg = 0;
  /// Of a maze: up to so many cells on the first robot's way over its goals (the nearest next) become
  /// walls after half as many moves, of all robots, as lead there; drawn with the seed, they leave a way
  /// from every start to its goals.
  int closing_doors = 0;
};

/// A free cell that becomes a wall once all robots together have entered so many cells.
struct Door {
  Cell cell;
  int after_moves = 0;
  bool operator==(const Door&) const = default;
};

/// A complete world for one seed: the truth, the robots' starts and goals, and the operator's
/// belief.
struct WorldSpec {
  OccupancyGrid truth;       // no unknown cells, border occupied
  OccupancyGrid human_map;   // the operator's initial map, as large as the truth
  Grid<char> wall_classes;   // texture class of each wall cell
  Grid<char> floor_classes;  // '.' corridor, letters rooms
  Grid<float> heights;       // metres above the water; empty: walls and floor
  double cell_size_m = 2.0;
  bool open = false;
  std::vector<Cell> starts;        // per robot, distinct
  double start_heading_rad = 0.0;  // of every robot
  std::vector<std::vector<Cell>>
      goals;  // per robot; equal lists when shared. All reachable from the start.
  bool shared_goals = false;
  std::vector<Door> doors;
};

/// Builds a world. Draws starts from the maze's P cells first and goals from its G cells first,
/// then both from the other free cells; drawn goals are different for each robot unless shared. If
/// a maze has fewer G cells than its preset has goals, generates the next one, as MemoryMaze does.
/// On a map file, draws starts and goals from the largest connected free area. Maze, starts, goals
/// and corruption have independent random sources, so that robot 1 is the same in a world with more
/// robots.
/// In open terrain all starts, goals and ways between them leave room for the robot and
/// kOpenMarginM, and SiltMap makes the operator's map, on which the shortest ways to the goals stay
/// open. On a waterway robots start around its start and each has a goal around its goal.
///
/// Errors: kNotFound (preset), those of LoadMapPair, LoadHeightMap and MakeTerrain (name file and
///         key), kOutOfRange
///         (too many robots or goals for the free cells, wrong_share, rotation_deg),
///         kInvalidArgument (doors in open terrain, given starts or goals that are walls, equal, too few, or unreachable
///         for the robot; a given start on a given goal; a map too small for its robots: says which
///         radius would do).
[[nodiscard]] Result<WorldSpec> MakeWorldSpec(const WorldOptions& options);

/// Turns truth, operator's map, textures, starts, goals and the robots' first heading
/// counter-clockwise around the middle. Rows and columns change places at 90 and 270 degrees.
/// Paper, section 6.2: layouts are reused, rotated. Errors: kOutOfRange when `rotation_deg` is not
/// 0, 90, 180 or 270.
[[nodiscard]] Result<WorldSpec> Rotated(WorldSpec spec, int rotation_deg);

}  // namespace conav::sim
