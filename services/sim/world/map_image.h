#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "common/grid/grid.h"
#include "common/runtime/result.h"

namespace conav::sim {

/// The keys of a map_server .yaml file, checked.
struct MapHeader {
  std::filesystem::path image;  // absolute, or relative to the working directory
  double resolution_m = 0.05;
  std::array<double, 3> origin{};  // x, y in metres, yaw (0)
  bool negate = false;
  double occupied_threshold = 0.65;
  double free_threshold = 0.196;
};

/// Errors as LoadMapFile.
[[nodiscard]] Result<MapHeader> ReadMapHeader(const std::filesystem::path& file);

/// One value per pixel, row 0 north. Darkness p in [0, 1] (lightness with negate) above
/// occupied_threshold is occupied, below free_threshold free, between them unknown.
[[nodiscard]] Result<OccupancyGrid> ReadMapImage(const MapHeader& header);

}  // namespace conav::sim
