#include <catch2/catch.hpp>

#include "sim/world/world_spec.h"

namespace conav::sim {
namespace {

/// Two rooms, of three and of two cells.
OccupancyGrid TwoRooms() {
  OccupancyGrid map(3, 8, Occupancy::kOccupied);
  for (const int column : {1, 2, 3, 5, 6}) map[{1, column}] = Occupancy::kFree;
  return map;
}

}  // namespace

TEST_CASE("the largest free area is found, none where nothing is free", "[sim][world]") {
  CHECK(LargestFreeArea(TwoRooms()) == std::set<Cell>{{1, 1}, {1, 2}, {1, 3}});
  CHECK(LargestFreeArea(OccupancyGrid(3, 3, Occupancy::kOccupied)).empty());
}

TEST_CASE("a deck hands out preferred cells first, each once, then says that it is empty",
          "[sim][world]") {
  Random random(1);
  const std::set<Cell> all{{0, 0}, {0, 1}, {0, 2}, {0, 3}};
  CellDeck deck({{0, 2}, {0, 3}, {9, 9}}, all, random);
  std::set<Cell> taken{{0, 0}};
  std::vector<Cell> drawn;
  for (int i = 0; i < 3; ++i) drawn.push_back(deck.Draw(taken).value());
  CHECK(std::set<Cell>(drawn.begin(), drawn.begin() + 2) == std::set<Cell>{{0, 2}, {0, 3}});
  CHECK(drawn[2] == Cell{0, 1});
  const auto empty = deck.Draw(taken);
  REQUIRE_FALSE(empty);
  CHECK(empty.error().code == ErrorCode::kOutOfRange);
}

}  // namespace conav::sim
