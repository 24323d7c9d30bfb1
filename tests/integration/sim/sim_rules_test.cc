#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "integration/sim/sim_harness.h"

namespace conav::sim {
namespace {

OccupancyGrid TruthOf(SimHarness& sim) {
  return ToDomain(Latched(sim.peer(), bus::kTruth, "w1")).value().cells;
}

}  // namespace

TEST_CASE("a move into a wall is blocked, and the wall is seen", "[sim][integration]") {
  SimHarness sim(BlindConfig());
  const Cell start = sim.robot().state().cell;
  Cell cell = start;
  const OccupancyGrid truth = TruthOf(sim);
  // Walk until a wall is beside the robot.
  while (truth[cell + Cell{0, 1}] == Occupancy::kFree) {
    REQUIRE(sim.Do(sim.robot().Move(cell + Cell{0, 1})) == CommandOutcome::kDone);
    cell = sim.robot().state().cell;
  }
  const Cell wall = cell + Cell{0, 1};
  CHECK(sim.Do(sim.robot().Move(wall)) == CommandOutcome::kBlocked);
  CHECK(sim.robot().state().cell == cell);
  CHECK(sim.robot().state().command_cell == wall);
  CHECK(sim.robot().maps.back().cells[wall] == Occupancy::kOccupied);
}

TEST_CASE("a command that has expired is not taken up", "[sim][integration]") {
  SimHarness sim(BlindConfig());
  const Cell start = sim.robot().state().cell;
  const Cell next = NeighbourThatIs(Occupancy::kFree, TruthOf(sim), start);
  CHECK(sim.Do(sim.robot().Move(next, 0.0)) == CommandOutcome::kExpired);
  CHECK(sim.robot().state().cell == start);
  CHECK(sim.robot().state().low_level_steps == 0);
}

TEST_CASE("a robot whose command expires on the way stops and can be commanded again",
          "[sim][integration]") {
  SimHarness sim(BlindConfig());
  const Cell start = sim.robot().state().cell;
  const OccupancyGrid truth = TruthOf(sim);
  const Cell next = NeighbourThatIs(Occupancy::kFree, truth, start);
  CHECK(sim.Do(sim.robot().Move(next, 1.0)) == CommandOutcome::kExpired);
  const Position stood = sim.robot().position;
  const SimTime then = sim.robot().state().stamp;
  CHECK(then.ToSeconds() < 3.0);
  CHECK_FALSE(sim.Turn());
  CHECK(sim.robot().position.x_m == stood.x_m);
  const Cell cell = sim.robot().state().cell;
  CHECK(sim.Do(sim.robot().Move(NeighbourThatIs(Occupancy::kFree, truth, cell))) ==
        CommandOutcome::kDone);
}

TEST_CASE("a planner with an older lease is refused", "[sim][integration]") {
  SimHarness sim(BlindConfig());
  const Cell start = sim.robot().state().cell;
  const OccupancyGrid truth = TruthOf(sim);
  sim.robot().epoch = 3;
  REQUIRE(sim.Do(sim.robot().Command(CommandKind::kStop)) == CommandOutcome::kDone);
  sim.robot().epoch = 2;
  const RobotState before = sim.robot().state();
  sim.Do(sim.robot().Move(NeighbourThatIs(Occupancy::kFree, truth, start)));
  CHECK(sim.robot().state() == before);
  sim.robot().epoch = 4;
  CHECK(sim.Do(sim.robot().Move(NeighbourThatIs(Occupancy::kFree, truth, start))) ==
        CommandOutcome::kDone);
  CHECK(sim.robot().state().lease_epoch == 4);
}

TEST_CASE("a command for another robot than the topic's is refused", "[sim][integration]") {
  SimHarness sim(BlindConfig(2));
  const RobotState before = sim.robot(1).state();
  const Cell next = NeighbourThatIs(Occupancy::kFree, TruthOf(sim), before.cell);
  sim.robot(0).Send(sim.robot(1).Move(next));
  CHECK_FALSE(sim.Turn());
  CHECK(sim.robot(1).state() == before);
}

TEST_CASE("a malformed command never reaches the robot", "[sim][integration]") {
  SimHarness sim(BlindConfig());
  const RobotState before = sim.robot().state();
  RobotCommand command = sim.robot().View(std::nan(""));
  sim.robot().Send(command);
  CHECK_FALSE(sim.Turn());
  CHECK(sim.robot().state() == before);
}

TEST_CASE("two robots are never in one cell, whatever they are told", "[sim][integration]") {
  SimConfig config = BlindConfig(4);
  SimHarness sim(config);
  const OccupancyGrid truth = TruthOf(sim);
  const GridGeometry geometry{truth.rows(), truth.columns(), 2.0};
  Random random(2);
  int occupied = 0;
  for (int turn = 0; turn < 600; ++turn) {
    for (std::size_t i = 0; i < 4; ++i) {
      RobotLink& robot = sim.robot(i);
      occupied += robot.state().command_outcome == CommandOutcome::kOccupied ? 1 : 0;
      if (robot.state().command_outcome != CommandOutcome::kRunning || random.Chance(0.05)) {
        // All are drawn to the first robot's cell, so that they meet.
        const Cell goal = sim.robot(0).state().cell;
        const Cell cell = robot.state().cell;
        const Cell towards{(goal.row > cell.row) - (goal.row < cell.row),
                           (goal.column > cell.column) - (goal.column < cell.column)};
        Cell offset = kNeighbourOffsets[static_cast<std::size_t>(random.Uniform(0, 3))];
        if (random.Chance(0.6) && towards != Cell{}) {
          offset = towards.row != 0 ? Cell{towards.row, 0} : Cell{0, towards.column};
        }
        robot.Send(robot.Move(cell + offset, 1.0 + random.Unit() * 5.0));
      }
    }
    if (!sim.Turn()) continue;
    std::set<Cell> cells;
    for (std::size_t i = 0; i < 4; ++i) {
      cells.insert(geometry.PositionToCell(sim.robot(i).position));
    }
    CHECK(cells.size() == 4);
  }
  CHECK(occupied > 0);
}

}  // namespace conav::sim
