#include "planner/follow_path.h"

#include <catch2/catch.hpp>

#include "planner/instruction_method.h"
#include "planner/teleop_method.h"

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

}  // namespace

TEST_CASE("the next cell of the path is taken", "[planner][instruction]") {
  const Decision decision = PathFollower().Next(OpenSituation());
  REQUIRE(decision.action);
  CHECK(decision.action->target == Cell{1, 2});
  CHECK(decision.plan == std::vector<Cell>{{1, 2}, {1, 3}});
  CHECK(decision.report.chosen == 0);
}

TEST_CASE("a path that comes through a cell twice is gone leg by leg", "[planner][instruction]") {
  PathFollower follower;
  Situation situation = OpenSituation();
  situation.guidance->path = {{1, 1}, {1, 2}, {1, 1}, {2, 1}};
  CHECK(follower.Next(situation).action->target == Cell{1, 2});
  situation.state.cell = {1, 2};
  CHECK(follower.Next(situation).action->target == Cell{1, 1});
  situation.state.cell = {1, 1};
  CHECK(follower.Next(situation).action->target == Cell{2, 1});
}

TEST_CASE("a new path is followed from its beginning", "[planner][instruction]") {
  PathFollower follower;
  Situation situation = OpenSituation();
  situation.state.cell = {1, 2};
  CHECK(follower.Next(situation).action->target == Cell{1, 3});
  situation.guidance->path = {{1, 2}, {2, 2}, {1, 2}, {1, 1}};
  CHECK(follower.Next(situation).action->target == Cell{2, 2});
}

TEST_CASE("teleoperation takes the first step of a tour that comes back", "[planner][teleop]") {
  Situation situation = OpenSituation();
  situation.guidance->path = {{1, 1}, {2, 1}, {1, 1}, {1, 2}};
  CHECK(TeleopMethod().Decide(situation).action->target == Cell{2, 1});
}

TEST_CASE("a known wall on the path makes the robot ask, and names the wall",
          "[planner][instruction]") {
  Situation situation = OpenSituation();
  situation.map.cells[{1, 2}] = Occupancy::kOccupied;
  const Decision decision = PathFollower().Next(situation);
  CHECK_FALSE(decision.action);
  CHECK(decision.attention == AttentionReason::kBlocked);
  CHECK(decision.attention_cell == Cell{1, 2});
}

TEST_CASE("without a path, at its end or beside it the robot asks for one",
          "[planner][instruction]") {
  Situation situation = OpenSituation();
  situation.state.cell = {1, 3};
  CHECK(PathFollower().Next(situation).attention == AttentionReason::kNoGuidance);
  situation.state.cell = {3, 3};
  CHECK(PathFollower().Next(situation).attention == AttentionReason::kNoGuidance);
  situation.guidance.reset();
  CHECK(PathFollower().Next(situation).attention == AttentionReason::kNoGuidance);
}

TEST_CASE("another robot on the next cell is waited for without asking", "[planner][instruction]") {
  Situation situation = OpenSituation();
  situation.neighbours = {{"r2", {1, 2}, {}}};
  const Decision decision = PathFollower().Next(situation);
  CHECK_FALSE(decision.action);
  CHECK_FALSE(decision.attention);
}

TEST_CASE("a robot without goals stays where it is", "[planner][instruction]") {
  Situation situation = OpenSituation();
  situation.state.goals_left.clear();
  CHECK_FALSE(InstructionMethod(1).Decide(situation).action);
  CHECK_FALSE(InstructionMethod(1).Decide(situation).attention);
}

TEST_CASE("teleoperation takes one step per order and then asks for the next",
          "[planner][teleop]") {
  TeleopMethod method;
  Situation situation = OpenSituation();
  CHECK(method.Decide(situation).action->target == Cell{1, 2});
  situation.state.cell = {1, 2};
  const Decision second = method.Decide(situation);
  CHECK_FALSE(second.action);
  CHECK(second.attention == AttentionReason::kNoGuidance);
  situation.guidance->revision = 2;
  CHECK(method.Decide(situation).action->target == Cell{1, 3});
}
