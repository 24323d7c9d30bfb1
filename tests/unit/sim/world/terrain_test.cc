#include "sim/world/terrain.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "sim/world/clearance.h"
#include "sim/world/world_spec.h"

namespace conav::sim {
namespace {

constexpr std::uint64_t kTerrainSeeds = 50;

OccupancyGrid MapOf(const std::vector<std::string>& rows) {
  OccupancyGrid map(static_cast<int>(rows.size()), static_cast<int>(rows.front().size()),
                    Occupancy::kFree);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Cell cell = map.CellAt(i);
    const char symbol =
        rows[static_cast<std::size_t>(cell.row)][static_cast<std::size_t>(cell.column)];
    if (symbol == '#') map.values()[i] = Occupancy::kOccupied;
  }
  return map;
}

std::uint64_t Hash(std::uint64_t hash, const OccupancyGrid& map) {
  for (const Occupancy cell : map.values()) {
    hash = (hash ^ static_cast<std::uint64_t>(cell)) * 0x100000001b3ULL;
  }
  return hash;
}

double StraightCells(Cell a, Cell b) {
  return std::hypot(double(a.row - b.row), double(a.column - b.column));
}

TEST_CASE("a robot has room where its disc touches neither a wall nor the edge", "[terrain]") {
  const OccupancyGrid map = MapOf({".....", ".....", "..#..", ".....", "....."});
  const Grid<std::uint8_t> narrow = RoomFor(map, 0.5);
  CHECK(std::ranges::count(narrow.values(), 1) == 24);
  const Grid<std::uint8_t> wide = RoomFor(map, 0.6);  // touches the cells next to it
  CHECK(std::ranges::count(wide.values(), 1) == 4);   // the corners of the inner 3 x 3
  CHECK(wide[{1, 1}] == 1);
  CHECK(RoomFor(map, 0.75)[{1, 1}] == 0);  // sqrt(0.5) from the wall's corner
  CHECK(WidestRadius(MapOf({"######", "#....#", "#....#", "######"}), {1, 1}, {2, 4}) == 0.5);
  CHECK(WidestRadius(MapOf({"#####", "#.#.#", "#####"}), {1, 1}, {1, 3}) < 0.0);
}

TEST_CASE("a waterway has a way to the goal and a dead end that tempts the greedy robot",
          "[terrain]") {
  for (std::uint64_t seed = 1; seed <= kTerrainSeeds; ++seed) {
    INFO("seed " << seed);
    const auto terrain = MakeTerrain({}, seed);
    REQUIRE(terrain);
    const Grid<int> steps = StepsFrom(RoomFor(terrain->truth, 0.5), terrain->goal);
    CHECK(steps[terrain->start] == terrain->shortest_way);
    CHECK(terrain->shortest_way > 0);
    CHECK(terrain->greedy_way >= kGreedyDetour * terrain->shortest_way);
    CHECK(steps[terrain->dead_end] >= terrain->shortest_way + 30);
    CHECK(StraightCells(terrain->dead_end, terrain->goal) + 30 <=
          StraightCells(terrain->start, terrain->goal));
    CHECK(std::abs(terrain->start.column - terrain->goal.column) > 100);
    for (std::size_t i = 0; i < terrain->truth.size(); ++i) {
      const bool water = terrain->truth.values()[i] == Occupancy::kFree;
      if (terrain->truth.OnBorder(terrain->truth.CellAt(i))) {
        REQUIRE(!water);
      } else {
        REQUIRE(water == (terrain->heights.values()[i] < 0.0F));
      }
    }
  }
}

/// Sizes of the connected pieces in which `map` differs from `truth`.
std::vector<std::size_t> PiecesOf(const OccupancyGrid& truth, const OccupancyGrid& map) {
  Grid<std::uint8_t> wrong(map.rows(), map.columns(), 0);
  for (std::size_t i = 0; i < map.size(); ++i) {
    wrong.values()[i] = truth.values()[i] != map.values()[i];
  }
  std::vector<std::size_t> sizes;
  for (;;) {
    const std::vector<Cell> piece = LargestArea(wrong);
    if (piece.empty()) return sizes;
    sizes.push_back(piece.size());
    for (const Cell cell : piece) wrong[cell] = 0;
  }
}

TEST_CASE("the operator's map of a waterway has channels silted up and opened", "[terrain]") {
  for (std::uint64_t seed = 1; seed <= kTerrainSeeds; ++seed) {
    INFO("seed " << seed);
    WorldOptions options;
    options.seed = seed;
    options.preset = kWaterwayPreset;
    const auto spec = MakeWorldSpec(options);
    REQUIRE(spec);
    CHECK(spec->open);
    std::map<Occupancy, long> wrong;
    for (std::size_t i = 0; i < spec->truth.size(); ++i) {
      const Occupancy drawn = spec->human_map.values()[i];
      if (drawn != spec->truth.values()[i]) ++wrong[drawn];
    }
    const auto water = std::ranges::count(spec->truth.values(), Occupancy::kFree);
    CHECK(wrong[Occupancy::kOccupied] + wrong[Occupancy::kFree] ==
          std::lround(0.12 * static_cast<double>(water)));
    CHECK(std::abs(wrong[Occupancy::kOccupied] - wrong[Occupancy::kFree]) <= 1);
    const std::vector<std::size_t> pieces = PiecesOf(spec->truth, spec->human_map);
    CHECK(pieces.size() <= 20);
    CHECK(std::ranges::count_if(pieces, [](std::size_t size) { return size < 12; }) <= 2);
    const Cell start = spec->starts.front();
    const Cell goal = spec->goals.front().front();
    const double radius_cells = 0.25;
    CHECK(StepsFrom(RoomFor(spec->human_map, radius_cells), start)[goal] > 0);
  }
}

TEST_CASE("equal seeds give equal waterways, on every machine", "[terrain]") {
  WorldOptions options;
  options.preset = kWaterwayPreset;
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    options.seed = seed;
    const auto spec = MakeWorldSpec(options);
    REQUIRE(spec);
    hash = Hash(Hash(hash, spec->truth), spec->human_map);
    const auto again = MakeWorldSpec(options);
    CHECK(spec->human_map == again->human_map);
    CHECK(spec->heights == again->heights);
  }
  CHECK(hash == 0x3c6dd94e987cab24ULL);
}

TEST_CASE("waterways take their size and robots, within limits", "[terrain]") {
  WorldOptions options;
  options.preset = kWaterwayPreset;
  options.terrain_rows = 110;
  options.terrain_columns = 180;
  options.robots = 4;
  options.robot_radius_m = 1.0;
  options.rotation_deg = 90;
  const auto spec = MakeWorldSpec(options);
  REQUIRE(spec);
  CHECK(spec->truth.rows() == 180);
  CHECK(spec->heights.rows() == 180);
  REQUIRE(spec->starts.size() == 4);
  for (std::size_t robot = 0; robot < 4; ++robot) {
    CHECK(StraightCells(spec->starts[robot], spec->starts[0]) < 20);
    CHECK(StraightCells(spec->goals[robot][0], spec->goals[0][0]) < 20);
    for (std::size_t other = 0; other < robot; ++other) {
      CHECK(StraightCells(spec->starts[robot], spec->starts[other]) > 2.0);
    }
  }
  for (const TerrainOptions& wrong : {TerrainOptions{.rows = 99}, TerrainOptions{.columns = 2000},
                                      TerrainOptions{.radius_cells = 5}}) {
    const auto refused = MakeTerrain(wrong, 1);
    REQUIRE(!refused);
    CHECK(refused.error().code == ErrorCode::kOutOfRange);
  }
}

}  // namespace
}  // namespace conav::sim
