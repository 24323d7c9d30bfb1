#pragma once

#include <optional>
#include <vector>

#include "common/grid/grid.h"
#include "common/runtime/result.h"
#include "sim/world/world_spec.h"

namespace conav::sim {

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
