#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "common/grid/grid.h"
#include "common/runtime/result.h"
#include "sim/world/world_spec.h"

namespace conav::sim {

struct MapFileOptions {
  /// Side of a navigation cell; at least the map's resolution.
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
};

/// The maze of the preset and seed, or the building of the map file. Errors as MakeWorldSpec.
[[nodiscard]] Result<Site> MakeSite(const WorldOptions& options);

}  // namespace conav::sim
