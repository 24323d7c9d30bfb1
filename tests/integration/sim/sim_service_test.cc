#include "sim/sim_service.h"

#include <poll.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <set>

#include "common/grid/map_accuracy.h"
#include "common/runtime/file.h"
#include "integration/sim/sim_harness.h"
#include "sim/world/clearance.h"
#include "support/temporary_folder.h"

namespace conav::sim {
namespace {

TEST_CASE("everything latched is there before the first command, without which time stands still",
          "[sim]") {
  SimHarness sim(BlindConfig());
  const OccupancyGrid truth = sim.Truth();
  const OccupancyGrid plan = ToDomain(sim.Latched(bus::kInitialMap, "w1")).value().cells;
  CHECK(CompareMaps(truth, plan, ToBelief(plan)).wrong_at_first == 20);
  CHECK(sim.Latched(bus::kGoals, "w1").markers().size() == 4);
  CHECK(sim.Latched(bus::kCameraInfo, "r1").width() == 320);
  REQUIRE(sim.robot().states.size() == 1);
  REQUIRE(sim.robot().maps.size() == 1);
  const RobotState& state = sim.robot().state();
  CHECK(state.world == "w1");
  CHECK(state.command_outcome == CommandOutcome::kNone);
  CHECK(state.goals_left.size() == 4);
  CHECK(truth[state.cell] == Occupancy::kFree);
  CHECK(sim.robot().maps.back().cells[state.cell] == Occupancy::kFree);
  CHECK(sim.robot().maps.back().stamp == state.map_stamp);
  sim.clock.Advance(std::chrono::hours(1));
  CHECK_FALSE(sim.Turn());
  CHECK(sim.robot().state().stamp == SimTime{});
}

TEST_CASE("a waterway is published, driven and looked at as a maze is", "[sim]") {
  SimConfig config = BlindConfig(2);
  config.preset = "waterway";
  config.body.radius_m = 0.5;
  SimHarness sim(config);
  const OccupancyGrid truth = sim.Truth();
  CHECK(truth.rows() == 150);
  const MapUpdate plan = ToDomain(sim.Latched(bus::kInitialMap, "w1")).value();
  CHECK(plan.cell_size_m == 1.0);
  CHECK_FALSE(plan.cells == truth);
  CHECK(sim.Latched(bus::kGoals, "w1").markers().size() == 2);
  CHECK(sim.Latched(bus::kRobotGoals, "r1").tolerance() == Approx(kOpenGoalM));
  CHECK(sim.robot().maps.back().cells.size() == truth.size());
  const Cell start = sim.robot().state().cell;
  RobotCommand command = sim.robot().Command(CommandKind::kMove);
  const Position from = sim.robot().state().position;
  command.path = {{from.x_m + 0.4, from.y_m}, {from.x_m + 0.4, from.y_m + 0.3}};
  command.tolerance_m = 0.2;
  CHECK(sim.Do(command) == CommandOutcome::kDone);
  CHECK(std::hypot(sim.robot().position.x_m - from.x_m - 0.4,
                   sim.robot().position.y_m - from.y_m - 0.3) < 0.1);
  CHECK(sim.Do(sim.robot().View(1.0)) == CommandOutcome::kDone);
  REQUIRE(sim.robot().snapshots.size() == 1);
  CHECK(sim.robot().snapshots.back().visible.free.size() > 20);
  CHECK(truth[start] == Occupancy::kFree);
}

TEST_CASE("a world that cannot be made stops the start with the reason", "[sim]") {
  SimConfig config = BlindConfig();
  config.preset = "waterway";
  config.terrain.cell_size_m = 0.1;
  config.body.radius_m = 1.0;
  CHECK_THROWS_WITH(SimHarness(config), Catch::Contains("too wide for a waterway"));
  config.preset = "lake";
  CHECK_THROWS_WITH(SimHarness(config), Catch::Contains("waterway"));
}

TEST_CASE("with a real-time factor time goes on by the clock", "[sim]") {
  SimConfig config = BlindConfig();
  config.speed = 2.0;
  SimHarness sim(config);
  bus::Subscriber<rosgraph_msgs::msg::Clock> clock(sim.peer(), bus::Sparse(bus::kClock));
  CHECK(sim.Turn());
  CHECK_FALSE(sim.Turn());
  sim.clock.Advance(std::chrono::milliseconds(500));
  int steps = 0;
  while (sim.Turn()) ++steps;
  CHECK(steps == 4);  // half a second at twice the speed, 4 Hz
  CHECK(ToDomain(clock.Take().back().clock()).value() == SimTime::FromSeconds(1.25));

  SimConfig without_clock = BlindConfig();
  without_clock.publish_clock = false;  // another world gives it
  SimHarness silent(without_clock);
  bus::Subscriber<rosgraph_msgs::msg::Clock> none(silent.peer(), bus::kClock);
  CHECK(silent.Do(silent.robot().View(1.0)) == CommandOutcome::kDone);
  CHECK(silent.robot().state().stamp > SimTime{});
  CHECK(none.Take().empty());
}

TEST_CASE("robots that wait publish the time twice per simulated second", "[sim]") {
  SimConfig config = BlindConfig(2);
  config.speed = 20.0;
  SimHarness sim(config);
  sim.clock.Advance(std::chrono::milliseconds(500));
  while (sim.Turn()) {
  }
  for (std::size_t robot = 0; robot < 2; ++robot) {
    const auto& states = sim.robot(robot).states;
    REQUIRE(states.size() == 21);
    for (std::size_t i = 0; i < states.size(); ++i) {
      CHECK(states[i].stamp == SimTime::FromSeconds(0.5 * static_cast<double>(i)));
    }
  }
}

TEST_CASE("goals are reached, claimed and taken off the markers when shared", "[sim]") {
  SimConfig config = BlindConfig(2);
  config.shared_goals = true;
  SimHarness probe(config);
  for (const auto& robot : probe.robots) {
    config.starts.push_back({robot->state().cell.row, robot->state().cell.column});
  }
  const Cell goal = probe.NeighbourThatIs(Occupancy::kFree, probe.robot().state().cell);
  config.goals = {{goal.row, goal.column}};
  SimHarness sim(config);
  REQUIRE(sim.Do(sim.robot().Move(goal)) == CommandOutcome::kDone);
  CHECK(sim.robot(0).state().goals_reached == std::vector<Cell>{goal});
  CHECK(sim.robot(0).maps.back().stamp == sim.robot(0).state().map_stamp);
  CHECK(sim.robot(1).state().goals_reached.empty());
  CHECK(sim.robot(1).state().goals_left.empty());
  constexpr std::int32_t kDelete = 2;
  CHECK(sim.Latched(bus::kGoals, "w1").markers().front().action() == kDelete);
}

TEST_CASE("a door that closes is a wall on the true map, in pictures, and for the robot", "[sim]") {
  SimConfig config = BlindConfig(1);
  config.preset = "open21";
  config.closing_doors = 1;
  WorldSpec world;
  std::vector<Cell> way;  // to the nearest goal, long enough for the door to close
  for (config.seed = 1;; ++config.seed) {
    world = MakeWorldSpec({.seed = config.seed, .preset = "open21", .closing_doors = 1}).value();
    const Grid<int> steps = StepsFrom(RoomFor(world.truth, 0.0), world.starts[0]);
    const Cell goal =
        *std::ranges::min_element(world.goals[0], {}, [&](Cell cell) { return steps[cell]; });
    way = WayBack(steps, goal);
    std::ranges::reverse(way);
    const auto at = std::ranges::find(way, world.doors[0].cell);
    if (at != way.end() && at - way.begin() > 4) break;
    REQUIRE(config.seed < 100);
  }
  SimHarness sim(config);
  const Cell door = world.doors[0].cell;
  const auto is_wall = [&] {
    const auto truth = ToDomain(sim.Latched(bus::kTruth, "w1"));
    return truth->cells[door] == Occupancy::kOccupied;
  };
  CHECK_FALSE(is_wall());
  CommandOutcome outcome = CommandOutcome::kDone;
  for (std::size_t i = 1; i < way.size() && outcome == CommandOutcome::kDone; ++i) {
    outcome = sim.Do(sim.robot().Move(way[i]));
  }
  CHECK(outcome == CommandOutcome::kBlocked);
  CHECK(is_wall());
  CHECK(sim.robot().maps.back().cells[door] == Occupancy::kOccupied);
  const Cell here = sim.robot().state().cell;
  REQUIRE(sim.Do(sim.robot().View(std::atan2(here.row - door.row, door.column - here.column))) ==
          CommandOutcome::kDone);
  CHECK(Contains(sim.robot().snapshots.back().visible.walls, door));
}

TEST_CASE("impossible configs stop the start with what is wrong", "[sim]") {
  const std::pair<const char*, void (*)(SimConfig&)> rows[] = {
      {"sim.robots", [](SimConfig& c) { c.robots.clear(); }},
      {"'r 1'", [](SimConfig& c) { c.robots = {"r 1"}; }},
      {"\"none\"", [](SimConfig& c) { c.preset = "none"; }},
      {"[1, 2, 3]",
       [](SimConfig& c) {
         c.starts.push_back({1, 2, 3});
       }},
  };
  for (const auto& [named, spoil] : rows) {
    SimConfig config = BlindConfig();
    spoil(config);
    CHECK_THROWS_WITH(SimHarness(config), Catch::Contains(named));
    CHECK_THROWS_AS(SimHarness(config), StartupError);
  }
}

TEST_CASE("a command that is malformed, for another robot, or of an older lease, is refused",
          "[sim]") {
  SimHarness sim(BlindConfig(2));
  sim.robot().epoch = 3;
  REQUIRE(sim.Do(sim.robot().Command(CommandKind::kStop)) == CommandOutcome::kDone);
  const RobotState before = sim.robot().state();
  const RobotState other = sim.robot(1).state();
  const Cell next = sim.NeighbourThatIs(Occupancy::kFree, before.cell);
  sim.robot().Send(sim.robot().View(std::nan("")));
  sim.robot().Send(sim.robot(1).Move(next));
  sim.robot().epoch = 2;
  sim.robot().Send(sim.robot().Move(next));
  CHECK_FALSE(sim.Turn());
  CHECK(sim.robot().state() == before);
  CHECK(sim.robot(1).state() == other);
}

TEST_CASE("two robots are never in one cell, whatever the commands", "[sim]") {
  SimConfig config = BlindConfig(4);
  SimHarness sim(config);
  const OccupancyGrid truth = sim.Truth();
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

// The faults report's section 2 (a): "sim | mission lost: robots at their starts, goals 0".
TEST_CASE("a simulator that was killed goes on where it was", "[sim]") {
  const test::TemporaryFolder folder;
  SimConfig config = BlindConfig(2);
  config.checkpoint = (folder / "w1.checkpoint").string();
  RobotState before;
  RobotState other;
  MapUpdate map;
  Snapshot picture;
  RobotCommand unfinished;
  {
    SimHarness probe(BlindConfig(2));
    const Cell start = probe.robot().state().cell;
    const Cell goal = probe.NeighbourThatIs(Occupancy::kFree, start);
    for (const auto& robot : probe.robots) {
      config.starts.push_back({robot->state().cell.row, robot->state().cell.column});
    }
    const Cell far = probe.robot().state().goals_left.front();
    config.goals = {{goal.row, goal.column}, {far.row, far.column}};
    config.shared_goals = true;
    SimHarness sim(config);
    sim.robot().epoch = 3;
    REQUIRE(sim.Do(sim.robot().Move(goal)) == CommandOutcome::kDone);
    REQUIRE(sim.Do(sim.robot().View(1.0)) == CommandOutcome::kDone);
    bus::Publisher stop(sim.peer(), bus::kStopOrder, "r2");
    REQUIRE(stop.Publish(ToMessage(StopOrder{{}, "w1", "r2", 4, true, "anna", ""})));
    unfinished = sim.robot().Move(start);
    sim.robot().Send(unfinished);
    for (int turn = 0; turn < 3; ++turn) sim.Turn();
    before = sim.robot().state();
    other = sim.robot(1).state();
    map = sim.robot().maps.back();
    picture = sim.robot().snapshots.back();
    REQUIRE(before.command_outcome == CommandOutcome::kRunning);
    REQUIRE(before.goals_reached.size() == 1);
  }  // without Run(), which would end it as one that is asked to
  SimHarness again(config);
  const RobotState state = again.robot().state();
  CHECK(state.stamp == before.stamp);
  CHECK(state.cell == before.cell);
  CHECK(state.path == before.path);
  CHECK(state.position.x_m == Approx(before.position.x_m));
  CHECK(state.goals_reached == before.goals_reached);
  CHECK(state.goals_left == before.goals_left);
  CHECK(state.cell_moves == before.cell_moves);
  CHECK(state.snapshots == 1);
  CHECK(state.lease_epoch == 3);
  CHECK(state.command_sequence_number == unfinished.sequence_number);
  CHECK(state.command_outcome == CommandOutcome::kExpired);
  CHECK(again.robot().maps.back() == map);
  CHECK(again.robot().snapshots == std::vector{picture});
  CHECK(again.robot(1).snapshots.empty());
  CHECK(again.robot(1).state().stopped);
  CHECK(again.robot(1).state().stop_revision == 4);
  CHECK(again.robot(1).state().cell == other.cell);
  constexpr std::int32_t kDelete = 2;
  CHECK(again.Latched(bus::kGoals, "w1").markers()[0].action() == kDelete);
  // The command is on its topic still, and comes again.
  CHECK(again.Do(unfinished) == CommandOutcome::kExpired);
  again.robot().epoch = 4;
  CHECK(again.Do(again.robot().Move(before.cell)) == CommandOutcome::kDone);

  StopToken stop;
  stop.RequestStop();
  again.service.Run(stop);
  CHECK(std::filesystem::is_empty(folder.path()));
}

TEST_CASE("a checkpoint of another world, or a damaged one, is not used", "[sim]") {
  const test::TemporaryFolder folder;
  SimConfig config = BlindConfig();
  config.checkpoint = (folder / "w1.checkpoint").string();
  {
    SimHarness sim(config);
    REQUIRE(sim.Step() == CommandOutcome::kDone);
  }
  const std::string whole = ReadFile(config.checkpoint).value();
  const auto moves = [&](const SimConfig& with) {
    return SimHarness(with).robot().state().cell_moves;
  };
  SimConfig another = config;
  another.seed = 10;
  CHECK(moves(another) == 0);
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{7}, whole.size() / 2, whole.size() - 1}) {
    REQUIRE(WriteFile(config.checkpoint, whole.substr(0, size)));
    CHECK(moves(config) == 0);
  }
  REQUIRE(WriteFile(config.checkpoint, whole));
  CHECK(moves(config) == 1);
}

TEST_CASE("time goes on over a restart of a simulator that follows the clock", "[sim]") {
  const test::TemporaryFolder folder;
  SimConfig config = BlindConfig();
  config.checkpoint = (folder / "w1.checkpoint").string();
  config.speed = 1000.0;
  { SimHarness sim(config); }
  poll(nullptr, 0, 5);
  CHECK(SimHarness(config).robot().state().stamp >= SimTime::FromSeconds(5.0));
}

}  // namespace
}  // namespace conav::sim
