#include "sim/physics/robot_world.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "common/runtime/random.h"
#include "unit/sim/physics/mazes.h"

namespace conav::sim {
namespace {

using test::MakeWorld;
using test::Open;

constexpr double kDegrees = 180.0 / std::numbers::pi;

/// Steps until the primitive ends; the number of steps.
int Finish(RobotWorld& world, int robot = 0) {
  int steps = 0;
  for (; world.motion_status(robot) == MotionStatus::kRunning; ++steps) world.Step();
  return steps;
}

double DistanceToCentre(const RobotWorld& world, int robot, Cell cell) {
  const Position centre = world.geometry().CellToPosition(cell);
  const Position at = world.pose(robot).position;
  return std::hypot(at.x_m - centre.x_m, at.y_m - centre.y_m);
}

std::vector<Cell> FreeNeighbours(const OccupancyGrid& truth, Cell cell) {
  std::vector<Cell> neighbours;
  for (const Cell offset : kNeighbourOffsets) {
    if (truth[cell + offset] == Occupancy::kFree) neighbours.push_back(cell + offset);
  }
  return neighbours;
}

TEST_CASE("a robot starts at rest in its cell with its heading", "[physics]") {
  PhysicsWorld spec = MakeWorld(test::kMaze, {3, 3});
  spec.robots[0].heading_rad = 2.0;
  const auto world = Open(spec);
  CHECK(world->cell(0) == Cell{3, 3});
  CHECK(world->pose(0).heading_rad == Approx(2.0));
  CHECK(world->motion_status(0) == MotionStatus::kIdle);
  for (int i = 0; i < 40; ++i) world->Step();
  CHECK(DistanceToCentre(*world, 0, {3, 3}) < 1e-3);
  CHECK(world->time_s() == 10.0);
}

// Figures measured on MemoryMaze's robot: metres per 4 Hz step from rest, then let go.
TEST_CASE("rolling speeds up and coasts like MemoryMaze's ball", "[physics]") {
  const auto world = Open(MakeWorld({"###########", "#.........#", "###########"}));
  const double driven[] = {0.224, 0.437, 0.486, 0.497, 0.499};
  const double coasted[] = {0.275, 0.062, 0.014};
  double last = world->pose(0).position.x_m;
  const auto step = [&] {
    world->Step();
    return world->pose(0).position.x_m - std::exchange(last, world->pose(0).position.x_m);
  };
  world->Drive(0, -1.0, 0.0);
  for (const double expected : driven) CHECK(step() == Approx(expected).margin(0.004));
  CHECK(world->pose(0).speed_mps == Approx(2.0).margin(0.01));
  world->Drive(0, 0.0, 0.0);
  for (const double expected : coasted) CHECK(step() == Approx(expected).margin(0.004));
}

TEST_CASE("steering turns 14 degrees in the first step and 18.4 in each further", "[physics]") {
  const auto world = Open(MakeWorld(test::kMaze));
  world->Drive(0, 0.0, 1.0);  // to the right: clockwise
  world->Step();
  CHECK(world->pose(0).heading_rad * kDegrees == Approx(-14.0).margin(0.3));
  for (int i = 1; i <= 4; ++i) {
    const double before = world->pose(0).heading_rad;
    world->Step();
    CHECK((world->pose(0).heading_rad - before) * kDegrees == Approx(-18.4).margin(0.15));
  }
}

TEST_CASE("200 random moves stay in the maze, short and centred", "[physics]") {
  const double cell_size_m = GENERATE(1.0, 2.0, 3.0);
  const auto world = Open(MakeWorld(test::kMaze, {1, 1}, cell_size_m));
  const OccupancyGrid& truth = world->world().truth;
  Random random(5);
  Cell cell{1, 1};
  for (int move = 0; move < 200; ++move) {
    const auto neighbours = FreeNeighbours(truth, cell);
    const Cell target = neighbours[static_cast<std::size_t>(
        random.Uniform(0, static_cast<std::int64_t>(neighbours.size()) - 1))];
    world->MoveTo(0, target);
    int steps = 0;
    for (; world->motion_status(0) == MotionStatus::kRunning; ++steps) {
      world->Step();
      const Cell at = world->cell(0);
      REQUIRE((at == cell || at == target));
    }
    CHECK(world->motion_status(0) == MotionStatus::kArrived);
    CHECK(steps < (cell_size_m > 2.0 ? 25 : 20));
    CHECK(DistanceToCentre(*world, 0, target) < 0.1);
    CHECK(std::abs(world->pose(0).speed_mps) < 0.05);
    cell = target;
  }
}

TEST_CASE("the same commands twice give the same poses, bit for bit", "[physics]") {
  const auto run = [] {
    const auto world = Open(MakeWorld(test::kMaze));
    std::vector<double> values;
    for (const Cell target : {Cell{1, 2}, Cell{1, 3}, Cell{2, 3}, Cell{1, 3}}) {
      world->MoveTo(0, target);
      while (world->motion_status(0) == MotionStatus::kRunning) {
        world->Step();
        const RobotPose pose = world->pose(0);
        values.insert(values.end(), {pose.position.x_m, pose.position.y_m, pose.heading_rad});
      }
    }
    return values;
  };
  CHECK(run() == run());
}

TEST_CASE("a robot turns to each of eight headings from each other", "[physics]") {
  const auto world = Open(MakeWorld(test::kMaze));
  for (int from = 0; from < 8; ++from) {
    for (int to = 0; to < 8; ++to) {
      world->Teleport(0, world->geometry().CellToPosition({1, 1}), HeadingFromIndex(from, 8));
      world->TurnTo(0, HeadingFromIndex(to, 8));
      CHECK(Finish(*world) <= 13);
      const double error = WrapAngle(world->pose(0).heading_rad - HeadingFromIndex(to, 8));
      CHECK(std::abs(error) * kDegrees < 2.0);
      CHECK(DistanceToCentre(*world, 0, {1, 1}) < 0.02);
    }
  }
}

TEST_CASE("halting from top speed takes a few steps, and the move can go on", "[physics]") {
  const auto world = Open(MakeWorld({"########", "#......#", "########"}));
  world->MoveTo(0, {1, 6});
  for (int i = 0; i < 6; ++i) world->Step();
  REQUIRE(world->pose(0).speed_mps > 1.9);
  const double before = world->pose(0).position.x_m;
  world->Halt(0);
  CHECK(Finish(*world) <= 3);
  CHECK(world->pose(0).position.x_m - before < 0.4);
  CHECK(std::abs(world->pose(0).speed_mps) < 0.05);
  world->MoveTo(0, {1, 6});
  Finish(*world);
  CHECK(DistanceToCentre(*world, 0, {1, 6}) < 0.1);
}

TEST_CASE("a move into a wall ends stuck, and the robot can leave, also from beside its line",
          "[physics]") {
  const auto world = Open(MakeWorld(test::kMaze));
  world->MoveTo(0, {0, 1});
  Finish(*world);
  CHECK(world->motion_status(0) == MotionStatus::kStuck);
  CHECK(world->cell(0) == Cell{1, 1});
  world->MoveTo(0, {1, 2});
  Finish(*world);
  CHECK(world->motion_status(0) == MotionStatus::kArrived);
  // From beside its line it comes back to the centre of the next cell.
  Position beside = world->geometry().CellToPosition({1, 1});
  beside.y_m += 0.3;
  world->Teleport(0, beside, 0.1);
  world->MoveTo(0, {1, 2});
  CHECK(Finish(*world) < 20);
  CHECK(DistanceToCentre(*world, 0, {1, 2}) < 0.1);
}

TEST_CASE("a door is no obstacle until it closes, then it is a wall", "[physics]") {
  PhysicsWorld plan = MakeWorld(test::kHall, {1, 1});
  plan.doors = {{1, 3}, {3, 3}};
  const auto world = Open(plan);
  const auto drive = [&](Cell target) {
    world->MoveTo(0, target);
    while (world->motion_status(0) == MotionStatus::kRunning) world->Step();
    return world->motion_status(0);
  };
  for (const int column : {2, 3, 4}) CHECK(drive({1, column}) == MotionStatus::kArrived);
  world->CloseDoor(0);
  CHECK(world->world().truth[{1, 3}] == Occupancy::kOccupied);
  CHECK(world->world().truth[{3, 3}] == Occupancy::kFree);
  CHECK(drive({1, 3}) == MotionStatus::kStuck);
  CHECK(world->cell(0) == Cell{1, 4});
  CHECK(drive({1, 5}) == MotionStatus::kArrived);

  plan.doors = {{0, 0}};
  CHECK_THAT(RobotWorld::Create(plan).error().text, Catch::Contains("door at (0,0) is inside"));
  plan.doors = {{1, 1}};
  CHECK_THAT(RobotWorld::Create(plan).error().text, Catch::Contains("is a robot's start"));
}

TEST_CASE("robots in neighbouring cells do not disturb each other", "[physics]") {
  const double cell_size_m = GENERATE(1.0, 2.0);
  PhysicsWorld spec = MakeWorld(test::kHall, {1, 1}, cell_size_m);
  spec.robots.push_back({"r2", {1, 2}, 0.0});
  spec.robots.push_back({"r3", {2, 1}, 0.0});
  const auto world = Open(spec);
  for (int i = 0; i < 3; ++i) world->TurnTo(i, 3.0);
  for (int i = 0; i < 3; ++i) Finish(*world, i);
  CHECK(DistanceToCentre(*world, 0, {1, 1}) < 0.02);
  CHECK(DistanceToCentre(*world, 1, {1, 2}) < 0.02);
  CHECK(DistanceToCentre(*world, 2, {2, 1}) < 0.02);
}

TEST_CASE(
    "robots move at the same time, each to its own target, and goals are visible until they are "
    "hidden",
    "[physics]") {
  PhysicsWorld spec = MakeWorld(test::kHall, {1, 1});
  spec.robots.push_back({"r2", {5, 7}, 0.0});
  spec.goals = {{{1, 2}, 0}, {{1, 3}, 7}};
  const auto world = Open(spec);
  world->MoveTo(0, {1, 2});
  world->MoveTo(1, {4, 7});
  Finish(*world, 0);
  Finish(*world, 1);
  CHECK(world->cell(0) == Cell{1, 2});
  CHECK(world->cell(1) == Cell{4, 7});
  CHECK(world->goal_visible(1));
  world->SetGoalVisible(1, false);
  CHECK_FALSE(world->goal_visible(1));
  CHECK(world->goal_visible(0));
}

RobotPose At(double x_m, double y_m, double heading_rad, double speed_mps = 0.0) {
  return {{x_m, y_m}, heading_rad, speed_mps, 0.0};
}

TEST_CASE("a target ahead is driven to at full speed, one aside is turned to first, the short way",
          "[physics]") {
  const ControlDecision ahead = DecideMove(At(0, 0, 0), {2, 0}, false);
  CHECK(ahead.controls.forward == 1.0);
  CHECK(ahead.controls.turn_left == Approx(0.0).margin(0.15));
  CHECK(ahead.driving);
  const ControlDecision left = DecideMove(At(0, 0, 0), {0, 2}, false);
  CHECK(left.controls.forward == 0.0);
  CHECK(left.controls.turn_left == 1.0);
  CHECK_FALSE(left.driving);
  CHECK(DecideTurn(At(0, 0, 3.0), -3.0).controls.turn_left > 0.0);
  CHECK(DecideTurn(At(0, 0, -3.0), 3.0).controls.turn_left < 0.0);
}

TEST_CASE("speed that coasting brings to the target needs no control", "[physics]") {
  // Coasting distance is the lag of 0.168 s times the speed.
  CHECK(DecideMove(At(0, 0, 0, 1.0), {0.168, 0}, true).controls.forward ==
        Approx(0.0).margin(1e-9));
  CHECK(DecideMove(At(0, 0, 0, 2.0), {0.168, 0}, true).controls.forward < 0.0);
}

}  // namespace
}  // namespace conav::sim
