#include "robot/driver/map_keeper.h"

#include <catch2/catch.hpp>
#include <functional>
#include <numbers>

namespace conav::robot {
namespace {

using namespace std::chrono_literals;
constexpr Clock::TimePoint kNoon{};
constexpr GridGeometry kSmallGrid{4, 6, 0.5};  // from (-1.5, -1) to (1.5, 1)
constexpr MapKeeper::Options kThickening{0.2, 25, 65};

/// A map whose frame is the plan's, turned and moved by `frame`, that covers `columns` x `rows` cells from
/// its own origin; `value` of a place on the plan.
RobotMap MapOf(const Pose& frame, double resolution_m, int columns, int rows,
               const std::function<int(Position)>& value) {
  RobotMap map{resolution_m, frame, columns, rows, {}};
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      map.data.push_back(static_cast<std::int8_t>(
          value(frame * Position{(column + 0.5) * resolution_m, (row + 0.5) * resolution_m})));
    }
  }
  return map;
}

int Count(const OccupancyGrid& grid, Occupancy what) {
  return static_cast<int>(std::ranges::count(grid.values(), what));
}

TEST_CASE("a map of any resolution, origin and turn is laid on the plan's cells",
          "[robot][driver]") {
  struct Row {
    Pose frame;
    double resolution_m;
    int columns, rows;
  };
  // All of them cover the plan.
  const Row row =
      GENERATE(Row{{{-2.0, -2.0}, 0.0}, 0.05, 80, 80}, Row{{{-2.1, -1.7}, 0.0}, 0.07, 60, 60},
               Row{{{0.0, -3.0}, std::numbers::pi / 4.0}, 0.05, 90, 90},
               Row{{{-3.0, -3.0}, 0.0}, 1.0, 6, 6});
  CAPTURE(row.resolution_m, row.frame.heading_rad);
  MapKeeper keeper(kSmallGrid, kThickening);
  CHECK(Count(keeper.Known(kNoon), Occupancy::kUnknown) == 24);
  keeper.Receive(MapOf(row.frame, row.resolution_m, row.columns, row.rows,
                       [](Position place) { return place.x_m < 1.0 ? 0 : 100; }));
  const OccupancyGrid known = keeper.Known(kNoon);
  CHECK(Count(known, Occupancy::kOccupied) == 4);  // the eastern column
  CHECK(Count(known, Occupancy::kFree) == 20);
  CHECK(known[{2, 5}] == Occupancy::kOccupied);
}

TEST_CASE("values between free and occupied are unknown", "[robot][driver]") {
  MapKeeper keeper(kSmallGrid, kThickening);
  keeper.Receive(MapOf({{-2.0, -2.0}, 0.0}, 0.1, 40, 40, [](Position place) {
    return place.x_m < -1.0 ? 25 : place.x_m < 1.0 ? 50 : -1;
  }));
  const OccupancyGrid known = keeper.Known(kNoon);
  CHECK(Count(known, Occupancy::kFree) == 4);
  CHECK(Count(known, Occupancy::kUnknown) == 20);
}

TEST_CASE("a wall is as thick as the robot needs: where it cannot stand in the middle of a cell",
          "[robot][driver]") {
  // A wall of 5 cm whose near side is so far east of the middle of column 2, at x = -0.25.
  const double distance_m = GENERATE(0.1, 0.17, 0.23);
  MapKeeper keeper(kSmallGrid, kThickening);
  keeper.Receive(MapOf({{-2.0, -2.0}, 0.0}, 0.01, 400, 400, [&](Position place) {
    const double east_m = place.x_m + 0.25;
    return east_m > distance_m && east_m < distance_m + 0.05 ? 100 : 0;
  }));
  const OccupancyGrid known = keeper.Known(kNoon);
  CAPTURE(distance_m);
  // At 0.23 m it can, and so it can east of the wall: then the wall itself must not vanish.
  CHECK(Count(known, Occupancy::kOccupied) == 4);
  const bool either =
      known[{1, 2}] == Occupancy::kOccupied || known[{1, 3}] == Occupancy::kOccupied;
  CHECK(either);
  if (distance_m < kThickening.radius_m) CHECK(known[{1, 2}] == Occupancy::kOccupied);
}

TEST_CASE("a wall of which only the surface is seen closes the cell behind it", "[robot][driver]") {
  MapKeeper keeper(kSmallGrid, kThickening);
  keeper.Receive(MapOf({{-2.0, -2.0}, 0.0}, 0.05, 80, 80, [](Position place) {
    if (place.x_m < 0.45) return 0;
    return place.x_m < 0.5 ? 100 : -1;  // the last strip of column 3
  }));
  const OccupancyGrid known = keeper.Known(kNoon);
  CHECK(known[{1, 3}] == Occupancy::kFree);
  CHECK(known[{1, 4}] == Occupancy::kOccupied);
  CHECK(known[{1, 5}] == Occupancy::kUnknown);
}

TEST_CASE(
    "a cell stays known when a rolling map no longer covers it, and changes when it is seen again",
    "[robot][driver]") {
  MapKeeper keeper(kSmallGrid, kThickening);
  const auto west_free = [](Position) { return 0; };
  keeper.Receive(MapOf({{-1.5, -1.0}, 0.0}, 0.05, 30, 40, west_free));
  CHECK(Count(keeper.Known(kNoon), Occupancy::kFree) == 12);
  keeper.Receive(MapOf({{0.0, -1.0}, 0.0}, 0.05, 30, 40, west_free));
  CHECK(Count(keeper.Known(kNoon), Occupancy::kFree) == 24);
  keeper.Receive(MapOf({{-1.5, -1.0}, 0.0}, 0.05, 10, 40, [](Position) { return 100; }));
  CHECK(keeper.Known(kNoon)[{1, 0}] == Occupancy::kOccupied);
  CHECK(keeper.Known(kNoon)[{1, 4}] == Occupancy::kFree);
}

TEST_CASE("the robot's own cell is free, and a way that did not work a wall for a while",
          "[robot][driver]") {
  MapKeeper keeper(kSmallGrid, kThickening);
  keeper.Receive(MapOf({{-1.5, -1.0}, 0.0}, 0.05, 60, 40, [](Position) { return 0; }));
  keeper.Block({1, 2}, kNoon + 10s);
  CHECK(keeper.Known(kNoon)[{1, 2}] == Occupancy::kOccupied);
  const Position west = kSmallGrid.CellToPosition({1, 0});
  const Position east = kSmallGrid.CellToPosition({1, 5});
  CHECK(keeper.FirstObstacle(west, east, kNoon) == Cell{1, 2});
  CHECK(keeper.Known(kNoon + 11s)[{1, 2}] == Occupancy::kFree);
  CHECK_FALSE(keeper.FirstObstacle(west, east, kNoon + 11s));
  keeper.Block({1, 0}, kNoon + 10s);
  keeper.Stand({1, 0});
  CHECK(keeper.Known(kNoon)[{1, 0}] == Occupancy::kFree);
}

TEST_CASE("a wall of the robot's own map stops the way, though the cells there are free",
          "[robot][driver]") {
  MapKeeper keeper(kSmallGrid, kThickening);
  // A post of 5 cm, in a corner of four cells: no middle is near, no line of middles crosses it.
  keeper.Receive(MapOf({{-1.5, -1.0}, 0.0}, 0.05, 60, 40, [](Position place) {
    return std::abs(place.x_m) < 0.05 && std::abs(place.y_m) < 0.05 ? 100 : 0;
  }));
  CHECK(Count(keeper.Known(kNoon), Occupancy::kOccupied) == 0);
  CHECK_FALSE(keeper.FirstObstacle({-0.5, 0.25}, {0.5, 0.25}, kNoon));
  CHECK(keeper.FirstObstacle({-0.5, 0.02}, {0.5, 0.02}, kNoon));
}

}  // namespace
}  // namespace conav::robot
