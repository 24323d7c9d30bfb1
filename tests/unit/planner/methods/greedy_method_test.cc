#include <catch2/catch.hpp>

#include "planner/decision/traffic.h"
#include "planner/methods/baseline_methods.h"
#include "unit/planner/search/text_map.h"

using namespace conav;
using namespace conav::planner;

namespace {

struct GreedyBench {
  GreedyBench() {
    situation.state.robot = "r1";
    situation.state.cell = {1, 1};
    situation.state.path = {{1, 1}};
    situation.state.goals_left = {{1, 5}};
    situation.map.cells = MapFrom(kRing);
  }

  std::optional<Cell> Target() {
    const Decision decision = method.Decide(situation, StopToken());
    CHECK_FALSE(decision.attention);
    if (!decision.action) return std::nullopt;
    CHECK(decision.action->kind == CommandKind::kMove);
    return decision.action->target;
  }

  Situation situation;
  FakeClock clock;
  GreedyMethod method{1, clock};
};

}  // namespace

TEST_CASE("the greedy robot takes the shortest way to its nearest goal", "[planner][greedy]") {
  GreedyBench bench;
  CHECK(bench.Target() == Cell{1, 2});
  CHECK(bench.method.IntendedPathFor(bench.situation).size() == 4);
  bench.situation.state.goals_left = {{1, 5}, {3, 1}};
  CHECK(bench.Target() == Cell{2, 1});
}

TEST_CASE("the greedy robot takes unseen cells for free and pays no heed to the operator",
          "[planner][greedy]") {
  GreedyBench bench;
  bench.situation.guidance = Guidance{.path = {{1, 1}, {2, 1}, {3, 1}}};
  CHECK(bench.method.awaits() == AwaitedInput::kNothing);
  bench.situation.map.cells[{1, 2}] = Occupancy::kUnknown;
  CHECK(bench.Target() == Cell{1, 2});
  bench.situation.map.cells[{1, 2}] = Occupancy::kOccupied;
  CHECK(bench.Target() == Cell{2, 1});
}

TEST_CASE("without goals, or a way to one, the greedy robot stays", "[planner][greedy]") {
  GreedyBench bench;
  bench.situation.state.goals_left = {};
  CHECK_FALSE(bench.Target());
  bench.situation.state.goals_left = {{2, 3}};
  CHECK_FALSE(bench.Target());
  bench.situation.state.goals_left = {{1, 5}};
  bench.situation.map.cells[{1, 4}] = bench.situation.map.cells[{3, 4}] = Occupancy::kOccupied;
  CHECK_FALSE(bench.Target());
}

TEST_CASE("the greedy robot waits for a robot in its way, then steps out at random",
          "[planner][greedy]") {
  GreedyBench bench;
  bench.situation.neighbours = {{"r2", {1, 2}, true, {}}};
  CHECK_FALSE(bench.Target());
  bench.clock.Advance(kPatience);
  CHECK(bench.Target() == Cell{2, 1});  // the only free one
  CHECK_FALSE(bench.Target());          // patience starts again
}
