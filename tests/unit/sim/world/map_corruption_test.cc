#include "sim/world/map_corruption.h"

#include <catch2/catch.hpp>
#include <cmath>

namespace conav::sim {
namespace {

/// Open cells on odd rows and columns' crossings, walls elsewhere, 13 x 13.
OccupancyGrid Lattice() {
  OccupancyGrid truth(13, 13, Occupancy::kOccupied);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Cell cell = truth.CellAt(i);
    if (truth.OnBorder(cell)) continue;
    if (cell.row % 2 == 1 || cell.column % 2 == 1) truth[cell] = Occupancy::kFree;
  }
  return truth;
}

std::vector<Cell> WrongCells(const OccupancyGrid& truth, const OccupancyGrid& map,
                             Occupancy actual) {
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (truth.values()[i] == actual && map.values()[i] != actual) cells.push_back(truth.CellAt(i));
  }
  return cells;
}

TEST_CASE("the operator's map has the exact number of wrong cells, half of each kind", "[map]") {
  const OccupancyGrid truth = Lattice();
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const OccupancyGrid map = CorruptMap(truth, {}, {}, seed).value();
    CHECK(CorruptMap(truth, {}, {}, seed).value() == map);
    CHECK(CorruptMap(truth, {}, {}, seed + 1).value() != map);
    CHECK(WrongCells(truth, map, Occupancy::kFree).size() == 10);
    CHECK(WrongCells(truth, map, Occupancy::kOccupied).size() == 10);
  }
}

TEST_CASE("kept cells and the border are never wrong", "[map]") {
  const OccupancyGrid truth = Lattice();
  std::set<Cell> kept;
  for (int column = 1; column < 12; ++column) kept.insert({1, column});
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const OccupancyGrid map = CorruptMap(truth, kept, {}, seed).value();
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const Cell cell = truth.CellAt(i);
      if (truth.OnBorder(cell) || kept.contains(cell)) CHECK(map[cell] == truth[cell]);
    }
  }
}

TEST_CASE("a wall that nobody can see is never missing", "[map]") {
  OccupancyGrid truth(13, 13, Occupancy::kOccupied);
  for (int column = 1; column < 12; ++column) truth[{1, column}] = Occupancy::kFree;
  MapCorruptionOptions options;
  options.wrong_share = 0.1;
  const OccupancyGrid map = CorruptMap(truth, {}, options, 1).value();
  for (const Cell cell : WrongCells(truth, map, Occupancy::kOccupied)) CHECK(cell.row == 2);
}

TEST_CASE("wrong cells lie closer together than chance", "[map]") {
  const OccupancyGrid truth = Lattice();
  const auto mean_distance = [&](const MapCorruptionOptions& options) {
    double sum = 0.0;
    int pairs = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
      const OccupancyGrid map = CorruptMap(truth, {}, options, seed).value();
      const std::vector<Cell> wrong = WrongCells(truth, map, Occupancy::kFree);
      for (const Cell a : wrong) {
        for (const Cell b : wrong) {
          sum += std::hypot(a.row - b.row, a.column - b.column);
          ++pairs;
        }
      }
    }
    return sum / pairs;
  };
  MapCorruptionOptions even;
  even.clusters = 0;
  CHECK(mean_distance({}) < 0.95 * mean_distance(even));
}

TEST_CASE("no errors can be asked for, more than cells that can be wrong cannot", "[map]") {
  CHECK(CorruptMap(Lattice(), {}, {.wrong_share = 0.0}, 1).value() == Lattice());
  const auto result = CorruptMap(Lattice(), {}, {.wrong_share = 1.0}, 1);
  REQUIRE_FALSE(result);
  CHECK_THAT(result.error().text, Catch::Contains("169") && Catch::Contains("121"));
}

}  // namespace
}  // namespace conav::sim
