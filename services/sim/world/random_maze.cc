#include "sim/world/random_maze.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace conav::sim {
namespace {

/// A maze under construction.
struct MazeDraft {
  Grid<char> entities;
  /// Region of each carved cell: rooms are 1..n, corridors n+1 and up; 0 = not carved.
  Grid<int> regions;
};

/// Down, up, right, left: labmaze's order of neighbours, which decides the meaning of a draw.
inline constexpr std::array<Cell, 4> kMazeDirections{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

/// Odd position, odd size.
struct MazeRoom {
  Cell north_west;
  int rows = 0;
  int columns = 0;
};

/// Draws only if there is a choice.
int DrawBetween(int low, int high, Random& random) {
  return low < high ? static_cast<int>(random.Uniform(low, high)) : low;
}

/// Works on the half-resolution grid of odd cells, so that rooms never touch.
MazeRoom DrawRoom(const RandomMazeOptions& options, Random& random) {
  const int half_rows = (options.height - 1) / 2;
  const int half_columns = (options.width - 1) / 2;
  const int low = (options.room_min_size - 1) / 2;
  const int high = (options.room_max_size - 1) / 2;
  const int middle = (low + high) / 2;
  int width = DrawBetween(low, middle, random);
  int height = DrawBetween(low, middle, random);
  int& long_side = DrawBetween(0, 1, random) == 0 ? width : height;
  long_side += DrawBetween(middle, high, random) - middle;
  const int row = DrawBetween(0, half_rows - height - 1, random);
  const int column = DrawBetween(0, half_columns - width - 1, random);
  return {{2 * row + 1, 2 * column + 1}, 2 * height + 1, 2 * width + 1};
}

bool Overlap(const MazeRoom& a, const MazeRoom& b) {
  return a.north_west.row < b.north_west.row + b.rows &&
         b.north_west.row < a.north_west.row + a.rows &&
         a.north_west.column < b.north_west.column + b.columns &&
         b.north_west.column < a.north_west.column + a.columns;
}

/// Stage 1: draws rooms until enough fit or too many did not, and shuffles them.
std::vector<MazeRoom> PlaceRooms(const RandomMazeOptions& options, Random& random) {
  std::vector<MazeRoom> rooms;
  int failures = 0;
  int covered = 0;
  const auto more_wanted = [&] {
    return options.max_rooms == 0 || static_cast<int>(rooms.size()) < options.max_rooms;
  };
  while (failures < options.retry_count && covered < options.height * options.width &&
         more_wanted()) {
    const MazeRoom room = DrawRoom(options, random);
    if (std::any_of(rooms.begin(), rooms.end(),
                    [&](const MazeRoom& other) { return Overlap(room, other); })) {
      ++failures;
      continue;
    }
    covered += room.rows * room.columns;
    rooms.push_back(room);
  }
  random.Shuffle(rooms);
  return rooms;
}

/// Opens the rooms; room i becomes region i + 1.
void CarveRooms(const std::vector<MazeRoom>& rooms, MazeDraft& draft) {
  int region = 0;
  for (const MazeRoom& room : rooms) {
    ++region;
    for (int row = 0; row < room.rows; ++row) {
      for (int column = 0; column < room.columns; ++column) {
        const Cell cell = room.north_west + Cell{row, column};
        draft.entities[cell] = kMazeFree;
        draft.regions[cell] = region;
      }
    }
  }
}

/// Up, down, left, right: the fill continues at the last free neighbour in this order.
constexpr std::array<Cell, 4> kFillDirections{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};

void FillFrom(Cell cell, Grid<char>& entities) {
  while (entities[cell] == kMazeFree) {
    int walls = 0;
    int neighbours = 0;
    bool goes_on = false;
    Cell next;
    for (const Cell direction : kFillDirections) {
      const Cell neighbour = cell + direction;
      if (!entities.Contains(neighbour)) continue;
      ++neighbours;
      if (entities[neighbour] == kMazeWall) ++walls;
      if (entities[neighbour] == kMazeFree) {
        goes_on = true;
        next = neighbour;
      }
    }
    if (walls + 1 < neighbours) return;
    entities[cell] = kMazeWall;
    if (!goes_on) return;
    cell = next;
  }
}

/// A bend seen from corner `p`: At(a, b) = p + a u + b v.
struct BendFrame {
  Cell p;
  Cell u;
  Cell v;
  int length;

  Cell At(int a, int b) const {
    return {p.row + a * u.row + b * v.row, p.column + a * u.column + b * v.column};
  }
};

bool IsBend(const BendFrame& frame, const Grid<char>& entities) {
  const auto is = [&](int a, int b, char wanted) {
    const Cell cell = frame.At(a, b);
    return entities.Contains(cell) && entities[cell] == wanted;
  };
  const int length = frame.length;
  for (int a = 0; a < length; ++a) {
    if (!is(a, 0, kMazeWall) || !is(a, -1, kMazeWall)) return false;
  }
  for (int a = -1; a <= length; ++a) {
    if (!is(a, 1, kMazeFree) || !is(a, 2, kMazeWall)) return false;
  }
  return is(-2, 1, kMazeWall) && is(length + 1, 1, kMazeWall) && is(-1, 0, kMazeFree) &&
         is(length, 0, kMazeFree);
}

void MoveDown(const BendFrame& frame, Grid<char>& entities) {
  for (int a = 0; a < frame.length; ++a) entities[frame.At(a, 0)] = entities[frame.At(a, 1)];
  for (int a = -1; a <= frame.length; ++a) entities[frame.At(a, 1)] = kMazeWall;
}

/// Straightens one bend at wall cell `p`; sets `p` to the next cell to look at.
bool StraightenOnce(Cell& p, int length, Grid<char>& entities) {
  if (!entities.Contains(p) || entities[p] != kMazeWall) return false;
  for (const Cell v : kMazeDirections) {
    const BendFrame frame{p, {v.column, -v.row}, v, length};
    if (!IsBend(frame, entities)) continue;
    MoveDown(frame, entities);
    p = frame.At(0, -1);
    return true;
  }
  return false;
}

/// Straightens the first bend of this length repeatedly; false if there is none.
bool StraightenFirst(int length, Grid<char>& entities) {
  for (std::size_t i = 0; i < entities.size(); ++i) {
    Cell p = entities.CellAt(i);
    if (!StraightenOnce(p, length, entities)) continue;
    while (StraightenOnce(p, length, entities)) {
    }
    return true;
  }
  return false;
}

/// Stage 4a: fills corridors that lead nowhere. Links count as neither wall nor free.
void FillDeadEnds(Grid<char>& entities) {
  for (std::size_t i = 0; i < entities.size(); ++i) FillFrom(entities.CellAt(i), entities);
}

/// Stage 4b: straightens bends in the shape of a horseshoe, short ones first. With u and v at right
/// angles and p the corner, a bend of length L = 3 and its result:
///
///     b=2    * * * * *              * * * * *
///     b=1  *           *   becomes  *         *     (p is the leftmost of b=0, a = -2 .. L+1)
///     b=0      * * *
///     b=-1     * * *
///
/// The path along b=1 moves down to b=0. Links stop a bend.
void StraightenBends(Grid<char>& entities) {
  int length = 1;
  while (length + 3 < entities.columns()) {
    const bool removed = StraightenFirst(length, entities);
    length = removed && length != 1 ? 1 : length + 1;
  }
}

/// One draw per carve, even if there is only one direction left.
void CarveFrom(Cell start, int region, Random& random, MazeDraft& draft) {
  const auto carve = [&](Cell cell) {
    draft.entities[cell] = kMazeFree;
    draft.regions[cell] = region;
  };
  carve(start);
  std::vector<Cell> trail{start};
  while (!trail.empty()) {
    const Cell cell = trail.back();
    std::vector<Cell> directions;
    for (const Cell direction : kMazeDirections) {
      const Cell far = cell + direction + direction;
      if (draft.regions.Contains(far) && draft.regions[far] == 0) directions.push_back(direction);
    }
    if (directions.empty()) {
      trail.pop_back();
      continue;
    }
    const auto drawn = random.Uniform(0, static_cast<std::int64_t>(directions.size()) - 1);
    const Cell direction = directions[static_cast<std::size_t>(drawn)];
    carve(cell + direction);
    carve(cell + direction + direction);
    trail.push_back(cell + direction + direction);
  }
}

/// Stage 2: fills the space between the rooms with corridors, one region per connected rest of odd
/// cells, each a spanning tree from a depth-first backtracker with two-cell steps.
void CarveCorridors(int first_region, Random& random, MazeDraft& draft) {
  int region = first_region;
  for (int row = 1; row < draft.regions.rows(); row += 2) {
    for (int column = 1; column < draft.regions.columns(); column += 2) {
      if (draft.regions[{row, column}] == 0) CarveFrom({row, column}, region++, random, draft);
    }
  }
}

/// Marks an opening between two regions in the entity layer, until ResolveLinks.
inline constexpr char kMazeLinkMark = '\x01';

struct MazeLink {
  Cell cell;
  Cell direction;
};

using RegionPair = std::pair<int, int>;  // the smaller region first
using LinksOfRegions = std::map<RegionPair, std::vector<MazeLink>>;

LinksOfRegions FindLinks(const Grid<int>& regions) {
  LinksOfRegions candidates;
  for (int row = 1; row < regions.rows(); row += 2) {
    for (int column = 1; column < regions.columns(); column += 2) {
      const Cell cell{row, column};
      for (const Cell direction : kMazeDirections) {
        const Cell far = cell + direction + direction;
        if (!regions.Contains(far) || regions[far] <= regions[cell]) continue;
        candidates[{regions[cell], regions[far]}].push_back({cell + direction, direction});
      }
    }
  }
  return candidates;
}

bool NextToLink(Cell cell, const Grid<char>& entities) {
  return std::any_of(kMazeDirections.begin(), kMazeDirections.end(), [&](Cell direction) {
    const Cell neighbour = cell + direction;
    return entities.Contains(neighbour) && entities[neighbour] == kMazeLinkMark;
  });
}

/// Stage 3: opens one wall cell between each pair of touching regions, and more with the extra
/// probability unless next to another link. Returns the links in the order of creation.
std::vector<MazeLink> ConnectRegions(double extra_connection_probability, Random& random,
                                     MazeDraft& draft) {
  const LinksOfRegions candidates = FindLinks(draft.regions);
  std::vector<MazeLink> links;
  const auto add = [&](const MazeLink& link) {
    draft.entities[link.cell] = kMazeLinkMark;
    links.push_back(link);
  };
  for (const auto& [pair, places] : candidates) {
    const auto drawn = random.Uniform(0, static_cast<std::int64_t>(places.size()) - 1);
    add(places[static_cast<std::size_t>(drawn)]);
  }
  for (const auto& [pair, places] : candidates) {
    for (const MazeLink& place : places) {
      // Drawn for every candidate, even if the probability is 0, to keep the random sequence.
      const bool wanted = random.Unit() <= extra_connection_probability;
      if (wanted && !NextToLink(place.cell, draft.entities)) add(place);
    }
  }
  return links;
}

/// Stage 7: closes each link that now leads to a wall because of the simplification; the others
/// become doors or free cells.
void ResolveLinks(const std::vector<MazeLink>& links, bool has_doors, Grid<char>& entities) {
  for (const MazeLink& link : links) {
    if (entities[link.cell + link.direction] == kMazeWall) {
      entities[link.cell] = kMazeWall;
    } else if (has_doors) {
      entities[link.cell] = link.direction.row != 0 ? kMazeVerticalDoor : kMazeHorizontalDoor;
    } else {
      entities[link.cell] = kMazeFree;
    }
  }
}

/// Stage 5: a letter for each room's cells, also for those that simplification filled.
Grid<char> RoomVariations(const Grid<int>& regions, int rooms, const RandomMazeOptions& options) {
  Grid<char> variations(regions.rows(), regions.columns(), kMazeNoVariation);
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const int region = regions.values()[i];
    if (region < 1 || region > rooms) continue;
    variations.values()[i] = static_cast<char>('A' + (region - 1) % options.max_variations);
  }
  return variations;
}

/// Stage 6: puts `token` on `per_room` random free cells of each room, or on as many as there are.
void PlaceTokens(const std::vector<MazeRoom>& rooms, char token, int per_room, Random& random,
                 Grid<char>& entities) {
  if (per_room <= 0) return;
  for (const MazeRoom& room : rooms) {
    std::vector<Cell> free_cells;
    for (int row = 0; row < room.rows; ++row) {
      for (int column = 0; column < room.columns; ++column) {
        const Cell cell = room.north_west + Cell{row, column};
        if (entities[cell] == kMazeFree) free_cells.push_back(cell);
      }
    }
    random.Shuffle(free_cells);
    const auto count = std::min(free_cells.size(), static_cast<std::size_t>(per_room));
    for (std::size_t i = 0; i < count; ++i) entities[free_cells[i]] = token;
  }
}

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
