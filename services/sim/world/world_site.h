#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "common/grid/grid.h"
#include "common/runtime/result.h"
#include "sim/world/world_spec.h"

namespace conav::sim {

struct MapFileOptions {
  /// Side of a navigation cell.
  double cell_size_m = 2.0;
  /// A cell is occupied when more than this share of its pixels is occupied or unknown.
  double occupied_share = 0.25;
};

/// Reads a ROS map_server map: a .yaml file (image, resolution, origin, negate, occupied_thresh,
/// free_thresh, mode "trinary") and its image (.pgm, .png, or any other format of OpenCV; the path
/// is relative to the .yaml file). Navigation cells start at the image's upper left (north-west)
/// corner; a last row or column that the image covers partly depends only on the pixels it has. The
/// outermost cells become walls. Every cell is free or occupied.
///
/// Errors (text names file, key, value and limit): kIo (file or image missing or unreadable),
/// kMalformed (missing key, wrong type, not YAML), kOutOfRange (resolution, thresholds, size),
/// kInvalidArgument (mode, rotated origin).
[[nodiscard]] Result<OccupancyGrid> LoadMapFile(const std::filesystem::path& file,
                                                const MapFileOptions& options);

struct MapPair {
  OccupancyGrid truth;
  OccupancyGrid plan;
};

struct HeightMap {
  OccupancyGrid cells;  // free = water
  Grid<float> heights;  // metres above the water, for the looks: the highest land is kHighestLandM
};

inline constexpr double kHighestLandM = 3.0;

/// Reads an image as heights, row 0 north: pixels below the water level are water. Cells and their
/// border as in LoadMapFile.
/// Errors (text names file, value and limit): kIo (missing, not an image), kInvalidArgument (not one
/// channel of 8 or 16 bits; all land, or all water), kOutOfRange (size in cells).
[[nodiscard]] Result<HeightMap> LoadHeightMap(const HeightMapOptions& map,
                                              const MapFileOptions& options);

/// A building as it is, and the operator's outdated plan of it. Errors: those of LoadMapFile, and
/// kInvalidArgument when the two differ in size or origin.
[[nodiscard]] Result<MapPair> LoadMapPair(const std::filesystem::path& truth,
                                          const std::filesystem::path& plan,
                                          const MapFileOptions& options);

/// A world without robots.
struct Site {
  OccupancyGrid truth;
  Grid<char> wall_classes;
  Grid<char> floor_classes;
  double cell_size_m = 2.0;
  std::vector<Cell> spawns;   // preferred starts
  std::vector<Cell> objects;  // preferred goals
  int goals = 4;              // default per robot
  std::optional<OccupancyGrid> plan;
  bool open = false;
  bool scalable = false;  // the size of its cells is free
  Grid<float> heights;    // as in WorldSpec
};

/// Rows and columns of maps from files.
inline constexpr int kMaxMapSide = 1024;

/// The maze of the preset and seed, the waterway, or the world of the map file. Errors as MakeWorldSpec.
[[nodiscard]] Result<Site> MakeSite(const WorldOptions& options);

}  // namespace conav::sim
