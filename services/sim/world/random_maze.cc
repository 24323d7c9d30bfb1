#include "sim/world/random_maze.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/world/maze_connections.h"
#include "sim/world/maze_corridors.h"
#include "sim/world/maze_rooms.h"
#include "sim/world/maze_simplification.h"
#include "sim/world/maze_tokens.h"

namespace conav::sim {
namespace {

Result<void> CheckSize(const char* name, int size) {
  if (size < 3) {
    return Fail(ErrorCode::kOutOfRange, fmt::format("{} {} is too small: at least 3", name, size));
  }
  if (size > kMaxMazeSize) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("{} {} is too large: at most {}", name, size, kMaxMazeSize));
  }
  if (size % 2 == 0) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{} {} is even: must be odd", name, size));
  }
  return {};
}

Result<void> CheckRoomSizes(const RandomMazeOptions& options) {
  if (options.room_min_size < 1) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("room-min {} is too small: at least 1", options.room_min_size));
  }
  if (options.room_min_size > options.room_max_size) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("room-min {} is larger than room-max {}", options.room_min_size,
                            options.room_max_size));
  }
  const int space = std::min(options.height, options.width) - 2;
  const int longest = options.room_max_size - (options.room_max_size + 1) % 2;
  if (longest > space) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("room-max {} does not fit: a {} x {} maze has {} cells between its "
                            "outer walls",
                            options.room_max_size, options.height, options.width, space));
  }
  return {};
}

Result<void> CheckAtLeast(const char* name, int value, int low) {
  if (value >= low) return {};
  return Fail(ErrorCode::kOutOfRange,
              fmt::format("{} {} is too small: at least {}", name, value, low));
}

}  // namespace

Result<void> CheckMazeOptions(const RandomMazeOptions& options) {
  const double probability = options.extra_connection_probability;
  if (!(probability >= 0.0 && probability <= 1.0)) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("extra-connection-probability {} is not in [0, 1]", probability));
  }
  return CheckSize("height", options.height)
      .and_then([&] { return CheckSize("width", options.width); })
      .and_then([&] { return CheckAtLeast("max-rooms", options.max_rooms, 0); })
      .and_then([&] { return CheckRoomSizes(options); })
      .and_then([&] { return CheckAtLeast("retry-count", options.retry_count, 0); })
      .and_then([&] { return CheckAtLeast("max-variations", options.max_variations, 1); })
      .and_then([&] { return CheckAtLeast("spawns-per-room", options.spawns_per_room, 0); })
      .and_then([&] { return CheckAtLeast("objects-per-room", options.objects_per_room, 0); });
}

RandomMaze::RandomMaze(const RandomMazeOptions& options, std::uint64_t seed)
    : options_(options), random_(seed) {
  const Result<void> valid = CheckMazeOptions(options);
  DEMAND(valid.has_value(), valid ? "" : valid.error().text);
}

Maze RandomMaze::Generate() {
  MazeDraft draft{Grid<char>(options_.height, options_.width, kMazeWall),
                  Grid<int>(options_.height, options_.width, 0)};
  const std::vector<MazeRoom> rooms = PlaceRooms(options_, random_);
  CarveRooms(rooms, draft);
  CarveCorridors(static_cast<int>(rooms.size()) + 1, random_, draft);
  const std::vector<MazeLink> links =
      ConnectRegions(options_.extra_connection_probability, random_, draft);
  if (options_.simplify) {
    FillDeadEnds(draft.entities);
    StraightenBends(draft.entities);
  }
  Maze maze;
  maze.variations = RoomVariations(draft.regions, static_cast<int>(rooms.size()), options_);
  PlaceTokens(rooms, kMazeSpawn, options_.spawns_per_room, random_, draft.entities);
  PlaceTokens(rooms, kMazeObject, options_.objects_per_room, random_, draft.entities);
  ResolveLinks(links, options_.has_doors, draft.entities);
  maze.entities = std::move(draft.entities);
  maze.rooms = static_cast<int>(rooms.size());
  return maze;
}

Maze GenerateMaze(const RandomMazeOptions& options, std::uint64_t seed, int generation) {
  DEMAND(generation >= 1, generation);
  RandomMaze maze(options, seed);
  for (int i = 1; i < generation; ++i) maze.Generate();
  return maze.Generate();
}

std::vector<std::string> ToLines(const Grid<char>& grid) {
  std::vector<std::string> lines;
  for (int row = 0; row < grid.rows(); ++row) {
    const auto cells =
        grid.values().subspan(grid.IndexOf({row, 0}), static_cast<std::size_t>(grid.columns()));
    lines.emplace_back(cells.begin(), cells.end());
  }
  return lines;
}

}  // namespace conav::sim
