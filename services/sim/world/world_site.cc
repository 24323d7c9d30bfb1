#include "sim/world/world_site.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "common/runtime/random.h"
#include "sim/world/clearance.h"
#include "sim/world/maze_presets.h"
#include "sim/world/random_maze.h"
#include "sim/world/terrain.h"

namespace conav::sim {
namespace {

/// Purpose for DeriveSeed: folds a seed beyond 32 bits, which MemoryMaze's mapping cannot take.
constexpr std::uint64_t kLargeSeed = 4;

constexpr int kMostGenerations = 100;

Site SiteFromMaze(const Maze& maze, int goals) {
  Site site;
  site.truth = OccupancyGrid(maze.entities.rows(), maze.entities.columns(), Occupancy::kFree);
  for (std::size_t i = 0; i < maze.entities.size(); ++i) {
    const char entity = maze.entities.values()[i];
    const Cell cell = maze.entities.CellAt(i);
    if (entity == kMazeWall) site.truth[cell] = Occupancy::kOccupied;
    if (entity == kMazeSpawn) site.spawns.push_back(cell);
    if (entity == kMazeObject) site.objects.push_back(cell);
  }
  site.wall_classes = BlockVariations(maze.entities);
  site.floor_classes = maze.variations;
  site.goals = goals;
  return site;
}

Result<Site> MakeMazeSite(const WorldOptions& options) {
  const Result<MazePreset> preset = FindMazePreset(options.preset);
  if (!preset) {
    return Fail(preset.error().code, fmt::format("{}, {}", preset.error().text, kWaterwayPreset));
  }
  constexpr std::uint64_t kLargestPaperSeed = std::numeric_limits<std::uint32_t>::max();
  const std::uint64_t seed = options.seed <= kLargestPaperSeed
                                 ? MazeSeedFromPaperSeed(static_cast<std::uint32_t>(options.seed))
                                 : DeriveSeed(options.seed, kLargeSeed);
  RandomMaze maze(preset->options, seed);
  for (int generation = 1; generation <= kMostGenerations; ++generation) {
    Site site = SiteFromMaze(maze.Generate(), preset->goals);
    if (generation >= kFirstEpisodeGeneration &&
        static_cast<int>(site.objects.size()) >= preset->goals) {
      return site;
    }
  }
  return Fail(ErrorCode::kOutOfRange,
              fmt::format("preset {} with seed {}: none of {} mazes has {} goals", options.preset,
                          options.seed, kMostGenerations, preset->goals));
}

/// Purpose for DeriveSeed.
constexpr std::uint64_t kTerrainSeed = 5;

/// `count` cells of the water around `middle`, itself first, `spacing_cells` apart from each other.
std::vector<Cell> Moorings(const Grid<std::uint8_t>& room, Cell middle, int count,
                           int spacing_cells) {
  const Grid<int> steps = StepsFrom(room, middle);
  std::vector<std::pair<int, Cell>> nearest;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps.values()[i] >= 0) nearest.emplace_back(steps.values()[i], steps.CellAt(i));
  }
  std::ranges::sort(nearest);
  std::vector<Cell> moorings;
  for (const auto& [distance, cell] : nearest) {
    if (static_cast<int>(moorings.size()) == count) break;
    const bool apart = std::ranges::all_of(moorings, [&, at = cell](Cell other) {
      const Cell away = other - at;
      return away.row * away.row + away.column * away.column > spacing_cells * spacing_cells;
    });
    if (apart) moorings.push_back(cell);
  }
  return moorings;
}

Result<Site> MakeWaterwaySite(const WorldOptions& options) {
  const double cell_size_m = options.terrain_cell_size_m;
  TerrainOptions terrain{options.terrain_rows, options.terrain_columns,
                         (options.robot_radius_m + kOpenMarginM) / cell_size_m};
  Result<Terrain> made = MakeTerrain(terrain, DeriveSeed(options.seed, kTerrainSeed));
  if (!made) return tl::unexpected(made.error());
  const Grid<std::uint8_t> room = RoomFor(made->truth, terrain.radius_cells);
  const int spacing = static_cast<int>(std::ceil(2.0 * terrain.radius_cells)) + 1;
  Site site;
  site.spawns = Moorings(room, made->start, options.robots, spacing);
  site.objects = Moorings(room, made->goal, options.robots, spacing);
  site.truth = std::move(made->truth);
  site.heights = std::move(made->heights);
  site.cell_size_m = cell_size_m;
  site.goals = 1;
  site.open = true;
  site.scalable = true;
  return site;
}

Result<Site> MakeMapSite(const WorldOptions& options) {
  const MapFileOptions file{options.cell_size_m, options.occupied_share};
  Site site;
  site.open = options.open || !options.height_map.image.empty();
  if (!options.height_map.image.empty()) {
    Result<HeightMap> map = LoadHeightMap(options.height_map, file);
    if (!map) return tl::unexpected(map.error());
    site.truth = std::move(map->cells);
    site.heights = std::move(map->heights);
  } else if (options.operator_map_yaml.empty()) {
    Result<OccupancyGrid> truth = LoadMapFile(options.map_yaml, file);
    if (!truth) return tl::unexpected(truth.error());
    site.truth = *std::move(truth);
  } else {
    Result<MapPair> pair = LoadMapPair(options.map_yaml, options.operator_map_yaml, file);
    if (!pair) return tl::unexpected(pair.error());
    site.truth = std::move(pair->truth);
    site.plan = std::move(pair->plan);
  }
  Grid<char> entities(site.truth.rows(), site.truth.columns(), kMazeFree);
  for (std::size_t i = 0; i < entities.size(); ++i) {
    if (site.truth.values()[i] == Occupancy::kOccupied) entities.values()[i] = kMazeWall;
  }
  site.wall_classes = BlockVariations(entities);
  site.floor_classes = Grid<char>(entities.rows(), entities.columns(), kMazeNoVariation);
  site.cell_size_m = options.cell_size_m;
  return site;
}

}  // namespace

Result<Site> MakeSite(const WorldOptions& options) {
  const bool from_file = !options.map_yaml.empty() || !options.height_map.image.empty();
  if (from_file) return MakeMapSite(options);
  return options.preset == kWaterwayPreset ? MakeWaterwaySite(options) : MakeMazeSite(options);
}

}  // namespace conav::sim
