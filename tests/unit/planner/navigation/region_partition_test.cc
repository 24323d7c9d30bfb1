#include "planner/navigation/region_partition.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "unit/planner/navigation/raster_worlds.h"
#include "unit/planner/search/text_map.h"

namespace conav::planner {
namespace {

RegionPartition PartitionOf(const OccupancyGrid& known, const RegionOptions& options = {}) {
  RegionPartition partition(options);
  partition.Update(known);
  return partition;
}

std::vector<int> CellsIn(const RegionPartition& partition) {
  std::vector<int> regions(partition.known().size());
  for (std::size_t i = 0; i < regions.size(); ++i) {
    regions[i] = partition.RegionOf(static_cast<int>(i));
  }
  return regions;
}

/// The nearest seed of each cell by relaxing all cells until nothing changes; of equals the smaller.
std::vector<int> NearestSeeds(const RegionPartition& partition) {
  using Key = std::pair<int, int>;  // steps, seed
  const Key none{std::numeric_limits<int>::max(), RegionPartition::kNone};
  const OccupancyGrid& known = partition.known();
  std::vector<Key> keys(known.size(), none);
  for (const int seed : partition.Seeds()) keys[static_cast<std::size_t>(seed)] = {0, seed};
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (!partition.IsTraversable(known.CellAt(i))) continue;
      partition.ForNeighbours(static_cast<int>(i), [&](int neighbour) {
        const Key from = keys[static_cast<std::size_t>(neighbour)];
        if (from == none || Key{from.first + 1, from.second} >= keys[i]) return;
        keys[i] = {from.first + 1, from.second};
        changed = true;
      });
    }
  }
  std::vector<int> seeds;
  for (const Key& key : keys) seeds.push_back(key.second);
  return seeds;
}

}  // namespace

TEST_CASE("Free and unknown cells are traversable, unknown ones of the ring are not",
          "[planner][navigation]") {
  const RegionPartition partition = PartitionOf(MapFrom({"???  ",  //
                                                         "?? # ",  //
                                                         "?????"}));
  CHECK(partition.IsTraversable({0, 3}));
  CHECK(partition.IsTraversable({1, 1}));
  CHECK_FALSE(partition.IsTraversable({0, 0}));
  CHECK_FALSE(partition.IsTraversable({1, 3}));
  CHECK_FALSE(partition.IsTraversable({5, 5}));
}

TEST_CASE("An obstacle closer than the clearance blocks a cell", "[planner][navigation]") {
  OccupancyGrid map(11, 11, Occupancy::kFree);
  map[{5, 5}] = Occupancy::kOccupied;
  for (const double clearance : {0.0, 1.0, 1.5, 3.0}) {
    const RegionPartition partition = PartitionOf(map, {.clearance_cells = clearance});
    for (std::size_t i = 0; i < map.size(); ++i) {
      const Cell way = map.CellAt(i) - Cell{5, 5};
      const double distance = std::hypot(way.row, way.column);
      CHECK(partition.IsTraversable(map.CellAt(i)) == (distance > 0 && distance >= clearance));
    }
  }
}

TEST_CASE("There are as many seeds as the density says", "[planner][navigation]") {
  const RegionPartition open = PartitionOf(OccupancyGrid(150, 150, Occupancy::kFree));
  CHECK(open.Seeds().size() == Approx(250).margin(10));
  const RegionPartition large = PartitionOf(OccupancyGrid(300, 450, Occupancy::kFree));
  CHECK(large.Seeds().size() == Approx(1500).margin(30));
  const RegionPartition dense =
      PartitionOf(OccupancyGrid(150, 150, Occupancy::kFree), {.cells_per_seed = 30});
  CHECK(dense.Seeds().size() == Approx(750).margin(25));
}

TEST_CASE("The set share of the seeds lies near obstacles", "[planner][navigation]") {
  // Posts so that each part of the map holds both.
  const OccupancyGrid map =
      RasterOf(240, 240, [](Cell cell) { return cell.row % 16 == 8 && cell.column % 16 == 8; });
  for (const double share : {0.0, 0.4, 0.8}) {
    const RegionPartition partition = PartitionOf(map, {.boundary_share = share});
    double near = 0.0;
    const auto seeds = partition.Seeds();
    for (const int seed : seeds) {
      const Cell cell = map.CellAt(static_cast<std::size_t>(seed));
      near += std::hypot(cell.row % 16 - 8, cell.column % 16 - 8) <= 4.0 ? 1.0 : 0.0;
    }
    CHECK(near / static_cast<double>(seeds.size()) == Approx(share).margin(0.05));
  }
}

TEST_CASE("Each traversable cell belongs to the geodesically nearest seed",
          "[planner][navigation]") {
  Random random(7);
  for (const OccupancyGrid& map :
       {Waterway(70, 12, random), Speckles(70, 0.3, random), ScaledMaze(12, 3, random)}) {
    const RegionPartition partition = PartitionOf(map);
    const std::vector<int> regions = CellsIn(partition);
    CHECK(regions == NearestSeeds(partition));
    for (std::size_t i = 0; i < map.size(); ++i) {
      CHECK((regions[i] != RegionPartition::kNone) == partition.IsTraversable(map.CellAt(i)));
    }
  }
}

TEST_CASE("A change moves seeds nearby alone", "[planner][navigation]") {
  Random random(3);
  OccupancyGrid map = Waterway(150, 25, random);
  RegionPartition partition = PartitionOf(map);
  const Cell changed{75, 75};
  map[changed] = map[changed] == Occupancy::kFree ? Occupancy::kOccupied : Occupancy::kFree;
  const std::vector<int> before = CellsIn(partition);
  partition.Update(map);
  const std::vector<int> after = CellsIn(partition);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Cell way = map.CellAt(i) - changed;
    if (std::abs(way.row) > 60 || std::abs(way.column) > 60) CHECK(before[i] == after[i]);
  }
}

TEST_CASE("An update of a partition equals a new one and names the regions that changed",
          "[planner][navigation]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    OccupancyGrid map = seed % 2 == 0 ? Waterway(64, 16, random) : Speckles(64, 0.35, random);
    const RegionOptions options{.cells_per_seed = 40, .clearance_cells = seed % 3 == 0 ? 2.0 : 0.0};
    RegionPartition partition = PartitionOf(map, options);
    for (int update = 0; update < 20; ++update) {
      const std::vector<int> before = CellsIn(partition);
      for (int i = 0; i < 12; ++i) {
        map.values()[static_cast<std::size_t>(random.Uniform(0, 64 * 64 - 1))] =
            static_cast<Occupancy>(random.Uniform(0, 2));
      }
      const RegionPartition::Changes& changes = partition.Update(map);
      const std::vector<int> after = CellsIn(partition);
      const RegionPartition anew = PartitionOf(map, options);
      REQUIRE(after == CellsIn(anew));
      REQUIRE(partition.Seeds() == anew.Seeds());
      std::set<int> changed;
      for (std::size_t i = 0; i < after.size(); ++i) {
        if (before[i] == after[i]) continue;
        changed.insert({before[i], after[i]});
      }
      changed.erase(RegionPartition::kNone);
      REQUIRE(changes.regions == std::vector<int>(changed.begin(), changed.end()));
    }
  }
}

}  // namespace conav::planner
