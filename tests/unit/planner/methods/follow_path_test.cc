#include <catch2/catch.hpp>

#include "planner/methods/baseline_methods.h"

using namespace conav;
using namespace conav::planner;

namespace {

/// A robot at (1,1) on an open 4x5 map, with a path to the east.
Situation OpenSituation() {
  Situation situation;
  situation.state.cell = {1, 1};
  situation.state.goals_left = {{1, 3}};
  situation.map.cells = OccupancyGrid(4, 5, Occupancy::kFree);
  situation.guidance = Guidance{.revision = 1, .path = {{1, 1}, {1, 2}, {1, 3}}};
  return situation;
}

struct FollowBench {
  Decision Next() { return follower.Next(situation); }
  void LetWait() { situation.neighbours = {{"r2", {1, 2}, true, {}}}; }

  FakeClock clock;
  PathFollower follower{1, clock};
  Situation situation = OpenSituation();
};

}  // namespace

TEST_CASE("a path is gone leg by leg, also where it comes through a cell twice",
          "[planner][instruction]") {
  FollowBench bench;
  const Decision first = bench.Next();
  REQUIRE(first.action);
  CHECK(first.action->target == Cell{1, 2});
  CHECK(first.plan == std::vector<Cell>{{1, 2}, {1, 3}});
  CHECK(first.report.chosen == 0);
  bench.situation.guidance->path = {{1, 1}, {1, 2}, {1, 1}, {2, 1}};
  CHECK(bench.Next().action->target == Cell{1, 2});
  bench.situation.state.cell = {1, 2};
  CHECK(bench.Next().action->target == Cell{1, 1});
  bench.situation.state.cell = {1, 1};
  CHECK(bench.Next().action->target == Cell{2, 1});
}

TEST_CASE("the same path given again, and a new path, are followed from their beginning",
          "[planner][instruction]") {
  FollowBench bench;
  bench.situation.state.cell = {1, 2};
  CHECK(bench.Next().action->target == Cell{1, 3});
  // Made room for another robot.
  bench.situation.state.cell = {1, 1};
  CHECK(bench.Next().attention == AttentionReason::kNoGuidance);
  SECTION("again by the operator") { bench.situation.guidance->revision = 2; }
  SECTION("again by a goal pose") { bench.situation.guidance->stamp = {5}; }
  SECTION("new") { bench.situation.guidance->path = {{1, 1}, {1, 2}, {1, 1}, {2, 1}}; }
  REQUIRE(bench.Next().action);
  CHECK(bench.Next().action->target == Cell{1, 2});
}

TEST_CASE("a robot asks where it cannot go on, and names what is in the way",
          "[planner][instruction]") {
  FollowBench bench;
  bench.situation.map.cells[{1, 2}] = Occupancy::kOccupied;
  const Decision blocked = bench.Next();
  CHECK_FALSE(blocked.action);
  CHECK(blocked.attention == AttentionReason::kBlocked);
  CHECK(blocked.attention_cell == Cell{1, 2});
  for (const Cell off : {Cell{1, 3}, Cell{3, 3}}) {  // at the path's end, beside it
    bench.situation.state.cell = off;
    CHECK(bench.Next().attention == AttentionReason::kNoGuidance);
  }
  bench.situation.guidance.reset();
  CHECK(bench.Next().attention == AttentionReason::kNoGuidance);
}

TEST_CASE("a robot waits for another one without asking, after half a second it steps aside",
          "[planner][instruction]") {
  FollowBench bench;
  bench.LetWait();
  const Decision waiting = bench.Next();
  CHECK_FALSE(waiting.action);
  CHECK_FALSE(waiting.attention);
  bench.clock.Advance(std::chrono::milliseconds(499));
  CHECK_FALSE(bench.Next().action);
  bench.clock.Advance(std::chrono::milliseconds(1));
  const Decision aside = bench.Next();
  REQUIRE(aside.action);
  CHECK(aside.action->target != Cell{1, 2});
}

TEST_CASE("a wait that ended does not count later", "[planner][instruction]") {
  FollowBench bench;
  bench.LetWait();
  bench.Next();
  SECTION("the cell was free meanwhile") {
    bench.situation.neighbours.clear();
    CHECK(bench.Next().action->target == Cell{1, 2});
    bench.LetWait();
  }
  SECTION("the robot was blocked meanwhile") {
    bench.situation.map.cells[{1, 2}] = Occupancy::kOccupied;
    bench.Next();
    bench.situation.map.cells[{1, 2}] = Occupancy::kFree;
  }
  SECTION("the path is a new one") { bench.situation.guidance->path = {{1, 1}, {1, 2}}; }
  bench.clock.Advance(std::chrono::seconds(1));
  CHECK_FALSE(bench.Next().action);
}

TEST_CASE("a robot without goals stays where it is", "[planner][instruction]") {
  FollowBench bench;
  bench.situation.state.goals_left.clear();
  const Decision decision = InstructionMethod(1, bench.clock).Decide(bench.situation, StopToken());
  CHECK_FALSE(decision.action);
  CHECK_FALSE(decision.attention);
}
