#include <catch2/catch.hpp>

#include "common/grid/map_accuracy.h"
#include "planner/methods/baseline_methods.h"
#include "unit/planner/search/text_map.h"

using namespace conav;
using namespace conav::planner;

namespace {

/// A robot that carries out commands at once.
struct MappingBench {
  MappingBench() {
    situation.state.robot = "r1";
    situation.state.cell = {1, 1};
    situation.state.goals_left = {{1, 5}};
    situation.map.cells = OccupancyGrid(5, 7, Occupancy::kUnknown);
    situation.truth = MapFrom(kRing);
    situation.belief.wall_probability = BeliefFrom(kRing);
  }

  Decision Decide() { return method.Decide(situation, StopToken()); }

  /// Drives until it has sent a picture; nothing when it stands before that.
  std::optional<Action> Snapshot() {
    for (int step = 0; step < 100; ++step) {
      const Decision decision = Decide();
      if (!decision.action) return std::nullopt;
      if (decision.action->kind == CommandKind::kTransmitView) {
        ++situation.state.snapshots;
        return decision.action;
      }
      CHECK(AreNeighbours(situation.state.cell, decision.action->target));
      situation.state.cell = decision.action->target;
    }
    return std::nullopt;
  }

  void Answer() { situation.answered_snapshot = situation.state.snapshots; }

  Situation situation;
  FakeClock clock;
  MappingMethod method{1, clock};
};

}  // namespace

TEST_CASE("the robot of the mapping task drives the shortest way in the true map to its goal",
          "[planner][mapping]") {
  MappingBench bench;
  const Decision first = bench.Decide();
  REQUIRE(first.action);
  CHECK(first.action->target == Cell{1, 2});
  CHECK(first.plan.size() == 4);
  CHECK_FALSE(first.attention);
  const auto picture = bench.Snapshot();
  REQUIRE(picture);
  CHECK(picture->target == Cell{1, 5});
}

TEST_CASE("after its picture the robot stands until it has the answer and the map of that answer",
          "[planner][mapping]") {
  MappingBench bench;
  REQUIRE(bench.Snapshot());
  CHECK_FALSE(bench.Decide().action);
  bench.situation.belief.revision = 2;  // edits alone do not count
  CHECK_FALSE(bench.Decide().action);
  CHECK(bench.method.IntendedPathFor(bench.situation).empty());
  bench.Answer();
  bench.situation.answered_belief = 3;
  CHECK_FALSE(bench.Decide().action);
  bench.situation.belief.revision = 3;
  CHECK(bench.Decide().action);
}

TEST_CASE("a picture that did not come about is tried again from the same place",
          "[planner][mapping]") {
  MappingBench bench;
  const auto picture = bench.Snapshot();
  --bench.situation.state.snapshots;
  const Decision again = bench.Decide();
  REQUIRE((picture && again.action));
  CHECK(again.action->kind == CommandKind::kTransmitView);
  CHECK(again.action->heading_rad == picture->heading_rad);
}

TEST_CASE("with all goals reached the robot goes on to other places", "[planner][mapping]") {
  MappingBench bench;
  bench.situation.state.goals_left = {};
  for (int i = 0; i < 5; ++i) {
    CHECK(bench.Snapshot());
    bench.Answer();
  }
}

TEST_CASE(
    "the robot of the mapping task waits for the true map, the operator's, and robots in "
    "its way",
    "[planner][mapping]") {
  MappingBench bench;
  CHECK(bench.method.awaits() == AwaitedInput::kBelief);
  bench.situation.neighbours = {{"r2", {1, 2}, true, {}}};
  CHECK_FALSE(bench.Decide().action);
  bench.situation.neighbours.clear();
  bench.situation.truth.reset();
  CHECK_FALSE(bench.Decide().action);
  CHECK(bench.method.IntendedPathFor(bench.situation).empty());
}
