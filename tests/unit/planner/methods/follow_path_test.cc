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

/// The same, with another robot on the next cell.
Situation TakenSituation() {
  Situation situation = OpenSituation();
  situation.neighbours = {{"r2", {1, 2}, true, {}}};
  return situation;
}

}  // namespace

TEST_CASE("the next cell of the path is taken", "[planner][instruction]") {
  const Decision decision = PathFollower(1, FakeClock{}).Next(OpenSituation());
  REQUIRE(decision.action);
  CHECK(decision.action->target == Cell{1, 2});
  CHECK(decision.plan == std::vector<Cell>{{1, 2}, {1, 3}});
  CHECK(decision.report.chosen == 0);
}

TEST_CASE("a path that comes through a cell twice is gone leg by leg", "[planner][instruction]") {
  const FakeClock clock;
  PathFollower follower(1, clock);
  Situation situation = OpenSituation();
  situation.guidance->path = {{1, 1}, {1, 2}, {1, 1}, {2, 1}};
  CHECK(follower.Next(situation).action->target == Cell{1, 2});
  situation.state.cell = {1, 2};
  CHECK(follower.Next(situation).action->target == Cell{1, 1});
  situation.state.cell = {1, 1};
  CHECK(follower.Next(situation).action->target == Cell{2, 1});
}

TEST_CASE("the same path given again is followed from its beginning", "[planner][instruction]") {
  const FakeClock clock;
  PathFollower follower(1, clock);
  Situation situation = OpenSituation();
  situation.state.cell = {1, 2};
  CHECK(follower.Next(situation).action->target == Cell{1, 3});
  // Made room for another robot.
  situation.state.cell = {1, 1};
  CHECK(follower.Next(situation).attention == AttentionReason::kNoGuidance);
  SECTION("by the operator") { situation.guidance->revision = 2; }
  SECTION("by a goal pose") { situation.guidance->stamp = {5}; }
  REQUIRE(follower.Next(situation).action);
  CHECK(follower.Next(situation).action->target == Cell{1, 2});
}

TEST_CASE("a new path is followed from its beginning", "[planner][instruction]") {
  const FakeClock clock;
  PathFollower follower(1, clock);
  Situation situation = OpenSituation();
  situation.state.cell = {1, 2};
  CHECK(follower.Next(situation).action->target == Cell{1, 3});
  situation.guidance->path = {{1, 2}, {2, 2}, {1, 2}, {1, 1}};
  CHECK(follower.Next(situation).action->target == Cell{2, 2});
}

TEST_CASE("a known wall on the path makes the robot ask, and names the wall",
          "[planner][instruction]") {
  Situation situation = OpenSituation();
  situation.map.cells[{1, 2}] = Occupancy::kOccupied;
  const Decision decision = PathFollower(1, FakeClock{}).Next(situation);
  CHECK_FALSE(decision.action);
  CHECK(decision.attention == AttentionReason::kBlocked);
  CHECK(decision.attention_cell == Cell{1, 2});
}

TEST_CASE("without a path, at its end or beside it the robot asks for one",
          "[planner][instruction]") {
  Situation situation = OpenSituation();
  situation.state.cell = {1, 3};
  CHECK(PathFollower(1, FakeClock{}).Next(situation).attention == AttentionReason::kNoGuidance);
  situation.state.cell = {3, 3};
  CHECK(PathFollower(1, FakeClock{}).Next(situation).attention == AttentionReason::kNoGuidance);
  situation.guidance.reset();
  CHECK(PathFollower(1, FakeClock{}).Next(situation).attention == AttentionReason::kNoGuidance);
}

TEST_CASE("another robot on the next cell is waited for without asking", "[planner][instruction]") {
  Situation situation = TakenSituation();
  const Decision decision = PathFollower(1, FakeClock{}).Next(situation);
  CHECK_FALSE(decision.action);
  CHECK_FALSE(decision.attention);
}

TEST_CASE("robots that wait for each other for half a second step out of the path",
          "[planner][instruction]") {
  FakeClock clock;
  PathFollower follower(1, clock);
  Situation situation = TakenSituation();
  follower.Next(situation);
  clock.Advance(std::chrono::milliseconds(499));
  CHECK_FALSE(follower.Next(situation).action);
  clock.Advance(std::chrono::milliseconds(1));
  const Decision decision = follower.Next(situation);
  REQUIRE(decision.action);
  CHECK(decision.action->target != Cell{1, 2});
}

TEST_CASE("a moment of waiting that ended does not count later", "[planner][instruction]") {
  FakeClock clock;
  PathFollower follower(1, clock);
  Situation situation = TakenSituation();
  follower.Next(situation);
  situation.neighbours.clear();
  CHECK(follower.Next(situation).action->target == Cell{1, 2});
  clock.Advance(std::chrono::seconds(1));
  situation.neighbours = {{"r2", {1, 2}, true, {}}};
  CHECK_FALSE(follower.Next(situation).action);
}

TEST_CASE("a robot without goals stays where it is", "[planner][instruction]") {
  Situation situation = OpenSituation();
  situation.state.goals_left.clear();
  CHECK_FALSE(InstructionMethod(1, FakeClock{}).Decide(situation, StopToken()).action);
  CHECK_FALSE(InstructionMethod(1, FakeClock{}).Decide(situation, StopToken()).attention);
}

TEST_CASE("a robot that was blocked while it waited waits anew afterwards",
          "[planner][instruction]") {
  FakeClock clock;
  PathFollower follower(1, clock);
  Situation situation = TakenSituation();
  follower.Next(situation);
  Situation blocked = situation;
  blocked.map.cells[{1, 2}] = Occupancy::kOccupied;
  follower.Next(blocked);
  clock.Advance(std::chrono::seconds(1));
  CHECK_FALSE(follower.Next(situation).action);
}

TEST_CASE("a new path ends the waiting on the old one", "[planner][instruction]") {
  FakeClock clock;
  PathFollower follower(1, clock);
  Situation situation = TakenSituation();
  follower.Next(situation);
  clock.Advance(std::chrono::seconds(1));
  situation.guidance->path = {{1, 1}, {1, 2}};
  CHECK_FALSE(follower.Next(situation).action);
}
