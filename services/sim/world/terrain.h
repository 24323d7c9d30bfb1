#pragma once

#include <cstdint>

#include "common/grid/grid.h"
#include "common/runtime/result.h"

// One user: the sites of worlds, which also come from mazes and files.

namespace conav::sim {

/// Sides from kMinTerrainSide: on a smaller map a robot sees the end of every channel at once.
struct TerrainOptions {
  int rows = 150;
  int columns = 150;
  /// What a robot needs around its middle, in cells.
  double radius_cells = 0.5;
};

inline constexpr int kMinTerrainSide = 100;
inline constexpr int kMaxTerrainSide = 1024;
/// The widest robot that channels are drawn for, as a share of the shorter side.
inline constexpr double kMaxTerrainRadius = 0.03;

/// A waterway. A way between start and goal, and a dead end, which a robot that always takes the
/// shortest way it knows of enters (paper, section 6.3: the greedy robot).
struct Terrain {
  Grid<float> heights;  // metres above the water; negative is water
  OccupancyGrid truth;  // free = water; the border is occupied
  Cell start;           // at the western or eastern end
  Cell goal;            // at the opposite end
  Cell dead_end;
  int shortest_way = 0;  // steps between 4-neighbours from start to goal
  int greedy_way = 0;    // the steps that the greedy robot takes
  int draws = 1;         // of which the last one holds all that is promised
};

/// Draws channels into smooth noise until all of this holds, for a robot of that radius:
/// 1. A way leads from the start to the goal.
/// 2. The greedy robot sees kGreedyRangeCells around itself, takes what it has not seen for water,
///    and takes at least kGreedyDetour times the steps of the shortest way.
/// 3. `dead_end` is the farthest it strays: by water at least a fifth of the shorter side farther
///    from the goal than the start is, in a straight line at least a fifth of it nearer.
/// Equal arguments give equal terrain on every machine: all decisions are made in integers.
/// Source: paper section 6.3 (a synthetic waterway "from a smooth height map").
/// Errors: kOutOfRange names the option and its limits; kUnavailable when no draw of many holds.
[[nodiscard]] Result<Terrain> MakeTerrain(const TerrainOptions& options, std::uint64_t seed);

inline constexpr int kGreedyRangeCells = 50;
inline constexpr double kGreedyDetour = 1.25;

}  // namespace conav::sim
