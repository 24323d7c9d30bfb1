#pragma once

#include <catch2/catch.hpp>
#include <memory>
#include <string>
#include <vector>

#include "sim/physics/robot_world.h"

/// Small hand-made worlds for the physics tests: '#' wall, others free; letters select the floor.
namespace conav::sim::test {

using Rows = std::vector<std::string>;

inline const Rows kMaze = {
    "#############",  //
    "#...#.......#",  //
    "#.#.#.#####.#",  //
    "#.#...#...#.#",  //
    "#.#####.#.#.#",  //
    "#..rrr..#...#",  //
    "#.#rrr#####.#",  //
    "#.#rrr..#...#",  //
    "#.#.###.#.#.#",  //
    "#...#.....#.#",  //
    "#.###.###.#.#",  //
    "#.....#.....#",  //
    "#############",  //
};

inline const Rows kWideMaze = {
    "#################",  //
    "#...#.......#...#",  //
    "#.#...#####...#.#",  //
    "#.#.#...#...#.#.#",  //
    "#...###...###...#",  //
    "#.#.....#.....#.#",  //
    "#################",  //
};

inline const Rows kHall = {
    "#########",  //
    "#.......#",  //
    "#..#....#",  //
    "#.......#",  //
    "#....#..#",  //
    "#.......#",  //
    "#########",  //
};

/// One robot "r1" at `start`, heading east; wall classes in 3x3 blocks; no goals.
inline PhysicsWorld MakeWorld(const Rows& rows, Cell start = {1, 1}, double cell_size_m = 2.0) {
  const int height = static_cast<int>(rows.size());
  const int width = static_cast<int>(rows.front().size());
  PhysicsWorld world;
  world.cell_size_m = cell_size_m;
  world.truth = OccupancyGrid(height, width, Occupancy::kFree);
  world.wall_classes = Grid<char>(height, width, '*');
  world.floor_classes = Grid<char>(height, width, '.');
  for (int r = 0; r < height; ++r) {
    for (int c = 0; c < width; ++c) {
      const char symbol = rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
      if (symbol == '#') world.truth[{r, c}] = Occupancy::kOccupied;
      world.wall_classes[{r, c}] = static_cast<char>('0' + r * 3 / height * 3 + c * 3 / width);
      world.floor_classes[{r, c}] = symbol;
    }
  }
  world.robots = {{"r1", start, 0.0}};
  return world;
}

inline std::unique_ptr<RobotWorld> Open(PhysicsWorld world) {
  auto created = RobotWorld::Create(std::move(world));
  REQUIRE(created);
  return std::move(created.value());
}

inline std::vector<Cell> FreeCells(const OccupancyGrid& truth) {
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (truth.values()[i] == Occupancy::kFree) cells.push_back(truth.CellAt(i));
  }
  return cells;
}

}  // namespace conav::sim::test
