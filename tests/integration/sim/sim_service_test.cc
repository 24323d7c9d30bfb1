#include "sim/sim_service.h"

#include <catch2/catch.hpp>

#include "common/grid/map_accuracy.h"
#include "integration/sim/sim_harness.h"

namespace conav::sim {
namespace {

OccupancyGrid TruthOf(SimHarness& sim) {
  return ToDomain(Latched(sim.peer(), bus::kTruth, "w1")).value().cells;
}

std::string RefusalOf(const SimConfig& config) {
  try {
    const SimHarness sim(config);
  } catch (const StartupError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("everything latched is there before the first command", "[sim][integration]") {
  SimHarness sim(BlindConfig());
  const OccupancyGrid truth = TruthOf(sim);
  const OccupancyGrid plan = ToDomain(Latched(sim.peer(), bus::kInitialMap, "w1")).value().cells;
  CHECK(CompareMaps(truth, plan, ToBelief(plan)).wrong_at_first == 20);
  CHECK(Latched(sim.peer(), bus::kGoals, "w1").markers().size() == 4);
  CHECK(Latched(sim.peer(), bus::kCameraInfo, "r1").width() == 320);
  REQUIRE(sim.robot().states.size() == 1);
  REQUIRE(sim.robot().maps.size() == 1);
  const RobotState& state = sim.robot().state();
  CHECK(state.world == "w1");
  CHECK(state.command_outcome == CommandOutcome::kNone);
  CHECK(state.goals_left.size() == 4);
  CHECK(truth[state.cell] == Occupancy::kFree);
  CHECK(sim.robot().maps.back().cells[state.cell] == Occupancy::kFree);
  CHECK(sim.robot().maps.back().stamp == state.map_stamp);
}

TEST_CASE("a move changes the cell, the counters, the path and the map", "[sim][integration]") {
  SimHarness sim(BlindConfig());
  const Cell start = sim.robot().state().cell;
  const Cell next = NeighbourThatIs(Occupancy::kFree, TruthOf(sim), start);
  CHECK(sim.Do(sim.robot().Move(next)) == CommandOutcome::kDone);
  const RobotState& state = sim.robot().state();
  CHECK(state.cell == next);
  CHECK(state.cell_moves == 1);
  CHECK(state.low_level_steps >= 3);
  CHECK(state.low_level_steps <= 20);
  CHECK(state.path == std::vector<Cell>{start, next});
  CHECK(sim.robot().maps.back().stamp == state.map_stamp);
  CHECK(sim.robot().maps.size() > 1);
}

TEST_CASE("what a robot maps is the truth", "[sim][integration]") {
  SimHarness sim(BlindConfig());
  const OccupancyGrid truth = TruthOf(sim);
  Random random(1);
  for (int i = 0; i < 30; ++i) {
    const Cell offset = kNeighbourOffsets[static_cast<std::size_t>(random.Uniform(0, 3))];
    sim.Do(sim.robot().Move(sim.robot().state().cell + offset));
  }
  const OccupancyGrid& map = sim.robot().maps.back().cells;
  int known = 0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map.values()[i] == Occupancy::kUnknown) continue;
    ++known;
    CHECK(map.values()[i] == truth.values()[i]);
  }
  CHECK(known > 10);
}

TEST_CASE("without a command time stands still at speed 0", "[sim][integration]") {
  SimHarness sim(BlindConfig());
  sim.clock.Advance(std::chrono::hours(1));
  CHECK_FALSE(sim.Turn());
  CHECK(sim.robot().state().stamp == SimTime{});
}

TEST_CASE("with a real-time factor time goes on by the clock", "[sim][integration]") {
  SimConfig config = BlindConfig();
  config.speed = 2.0;
  SimHarness sim(config);
  bus::Subscriber<rosgraph_msgs::msg::Clock> clock(sim.peer(), bus::kClock);
  CHECK(sim.Turn());
  CHECK_FALSE(sim.Turn());
  sim.clock.Advance(std::chrono::milliseconds(500));
  int steps = 0;
  while (sim.Turn()) ++steps;
  CHECK(steps == 4);  // half a second at twice the speed, 4 Hz
  CHECK(ToDomain(clock.Take().back().clock()).value() == SimTime::FromSeconds(1.25));
}

TEST_CASE("robots that wait tell the time twice per simulated second", "[sim][integration]") {
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

TEST_CASE("a world whose clock another one gives publishes none", "[sim][integration]") {
  SimConfig config = BlindConfig();
  config.publish_clock = false;
  SimHarness sim(config);
  bus::Subscriber<rosgraph_msgs::msg::Clock> clock(sim.peer(), bus::kClock);
  CHECK(sim.Do(sim.robot().View(1.0)) == CommandOutcome::kDone);
  CHECK(sim.robot().state().stamp > SimTime{});
  CHECK(clock.Take().empty());
}

TEST_CASE("the same commands give the same states and maps", "[sim][integration]") {
  const auto run = [] {
    SimHarness sim(BlindConfig());
    Random random(5);
    for (int i = 0; i < 25; ++i) {
      const Cell offset = kNeighbourOffsets[static_cast<std::size_t>(random.Uniform(0, 3))];
      sim.Do(sim.robot().Move(sim.robot().state().cell + offset));
      if (i % 6 == 5) sim.Do(sim.robot().View(random.Unit() * 3.0));
    }
    return std::make_tuple(sim.robot().states, sim.robot().maps, sim.robot().pictures);
  };
  CHECK(run() == run());
}

TEST_CASE("goals are reached, claimed and taken off the markers when shared",
          "[sim][integration]") {
  SimConfig config = BlindConfig(2);
  config.shared_goals = true;
  SimHarness probe(config);
  const OccupancyGrid truth = TruthOf(probe);
  const Cell start = probe.robot().state().cell;
  config.starts = {{start.row, start.column},
                   {probe.robot(1).state().cell.row, probe.robot(1).state().cell.column}};
  const Cell goal = NeighbourThatIs(Occupancy::kFree, truth, start);
  config.goals = {{goal.row, goal.column}};
  SimHarness sim(config);
  REQUIRE(sim.Do(sim.robot().Move(goal)) == CommandOutcome::kDone);
  CHECK(sim.robot(0).state().goals_reached == std::vector<Cell>{goal});
  CHECK(sim.robot(0).state().goals_left.empty());
  CHECK(sim.robot(1).state().goals_reached.empty());
  CHECK(sim.robot(1).state().goals_left.empty());
  CHECK(sim.robot(1).state().goals_total == 1);
  constexpr std::int32_t kDelete = 2;
  CHECK(Latched(sim.peer(), bus::kGoals, "w1").markers().front().action() == kDelete);
}

TEST_CASE("impossible configs stop the start with what is wrong", "[sim][integration]") {
  SimConfig config = BlindConfig();
  SECTION("no robot") {
    config.robots.clear();
    CHECK(RefusalOf(config) == "sim.robots: a world needs at least one robot");
  }
  SECTION("a name that is no topic") {
    config.robots = {"r 1"};
    CHECK(RefusalOf(config) == "sim.robots: 'r 1' is no name: 1 to 64 of A-Z a-z 0-9 _");
  }
  SECTION("preset") {
    config.preset = "none";
    CHECK_THAT(RefusalOf(config), Catch::StartsWith("maze preset \"none\" is unknown"));
  }
  SECTION("map") {
    config.map.yaml = "/none.yaml";
    CHECK(RefusalOf(config) == "/none.yaml: no such file");
  }
  SECTION("start that is no cell") {
    config.starts = {{1, 2, 3}};
    CHECK(RefusalOf(config) == "sim.starts: [1, 2, 3] is no [row, column]");
  }
}

}  // namespace conav::sim
