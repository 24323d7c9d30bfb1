#include "sim/world/world_site.h"

#include <fmt/format.h>

#include <limits>

#include "common/runtime/random.h"
#include "sim/world/map_file.h"
#include "sim/world/maze_presets.h"

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
  if (!preset) return tl::unexpected(preset.error());
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

Result<Site> MakeMapSite(const WorldOptions& options) {
  const MapFileOptions file{options.cell_size_m, options.occupied_share};
  Site site;
  if (options.operator_map_yaml.empty()) {
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
  return options.map_yaml.empty() ? MakeMazeSite(options) : MakeMapSite(options);
}

}  // namespace conav::sim
