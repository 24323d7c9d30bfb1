#include "common/grid/mapping_tour.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <set>

#include "common/grid/geometry.h"
#include "common/grid/map_accuracy.h"

namespace conav {
namespace {

/// An empty room of 7x7 cells with a border, and a closed chamber of one cell in it.
OccupancyGrid Room() {
  OccupancyGrid map(9, 9, Occupancy::kFree);
  for (int i = 0; i < 9; ++i) {
    map[{0, i}] = map[{8, i}] = map[{i, 0}] = map[{i, 8}] = Occupancy::kOccupied;
  }
  for (const Cell offset : kNeighbourOffsets) map[Cell{6, 6} + offset] = Occupancy::kOccupied;
  return map;
}

constexpr Cell kStart{1, 1};
constexpr Cell kChamber{6, 6};

std::set<Cell> CellsOf(MappingTour& tour, const BeliefGrid& belief, int stops) {
  std::set<Cell> cells;
  Cell at = kStart;
  for (int i = 0; i < stops; ++i) cells.insert(at = tour.Next(Room(), belief, at).cell);
  return cells;
}

TEST_CASE("a mapping tour visits every goal once, in an order that the seed draws", "[mapping]") {
  const std::vector<Cell> goals{{1, 3}, {3, 1}, {5, 1}, {2, 5}};
  const BeliefGrid belief = ToBelief(Room());
  std::set<Cell> first;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    MappingTour tour(goals, {}, seed);
    first.insert(tour.Next(Room(), belief, kStart).cell);
    MappingTour again(goals, {}, seed);
    CHECK(CellsOf(again, belief, 4) == std::set<Cell>(goals.begin(), goals.end()));
  }
  CHECK(first.size() == 4);
}

TEST_CASE("after the goals a mapping tour prefers cells near the mistakes of the map",
          "[mapping]") {
  BeliefGrid belief = ToBelief(Room());
  belief[{1, 7}] = 1.0F;  // a wall that is not there
  MappingTour tour({}, {.background = 0.0, .attraction_cells = 1.0}, 3);
  CHECK(CellsOf(tour, belief, 40) == std::set<Cell>{{1, 6}, {1, 7}, {2, 7}});
}

TEST_CASE("where no place attracts a mapping tour goes to any cell that can be reached",
          "[mapping]") {
  MappingTour tour({}, {.background = 0.0}, 3);
  const std::set<Cell> visited = CellsOf(tour, ToBelief(Room()), 600);
  CHECK(visited.size() == 43);  // 49 without the chamber, its four walls and the corner behind
  CHECK_FALSE(visited.contains(kChamber));
}

TEST_CASE(
    "a mapping tour leaves out goals that nobody can reach, and a robot that cannot leave its "
    "cell stays",
    "[mapping]") {
  MappingTour unreachable({kChamber}, {}, 3);
  CHECK(unreachable.Next(Room(), ToBelief(Room()), kStart).cell != kChamber);
  MappingTour tour({{1, 1}}, {}, 3);
  CHECK(tour.Next(Room(), ToBelief(Room()), kChamber).cell == kChamber);
}

TEST_CASE("a mapping tour looks to all its headings", "[mapping]") {
  MappingTour tour({}, {.headings = 4}, 3);
  std::set<double> headings;
  for (int i = 0; i < 100; ++i) {
    headings.insert(tour.Next(Room(), ToBelief(Room()), kStart).heading_rad);
  }
  std::set<double> four;
  for (int i = 0; i < 4; ++i) four.insert(HeadingFromIndex(i, 4));
  CHECK(headings == four);
}

TEST_CASE("equal seeds give equal mapping tours, other seeds others", "[mapping]") {
  const auto stops = [](std::uint64_t seed) {
    MappingTour tour({{1, 3}, {3, 1}}, {}, seed);
    std::vector<MappingStop> all;
    for (int i = 0; i < 10; ++i) all.push_back(tour.Next(Room(), ToBelief(Room()), kStart));
    return all;
  };
  CHECK(stops(7) == stops(7));
  CHECK(stops(7) != stops(8));
}

TEST_CASE("options of a mapping tour out of range are refused by name", "[mapping]") {
  const auto refusal = [](const MappingTourOptions& options) {
    const auto checked = CheckMappingTourOptions(options);
    REQUIRE_FALSE(checked);
    CHECK(checked.error().code == ErrorCode::kInvalidArgument);
    return checked.error().text;
  };
  CHECK_THAT(refusal({.headings = 361}), Catch::StartsWith("headings = 361"));
  CHECK_THAT(refusal({.background = std::nan("")}), Catch::StartsWith("background = nan"));
  CHECK_THAT(refusal({.attraction_cells = -1.0}), Catch::StartsWith("attraction_cells = -1"));
}

}  // namespace
}  // namespace conav
