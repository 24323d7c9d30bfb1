#include "planner/decision/blackboard.h"

#include <catch2/catch.hpp>
#include <map>
#include <thread>

using namespace conav;
using namespace conav::planner;

namespace {

const std::map<std::string, std::string> kOneRobot{{"r1", "w1"}};

}  // namespace

TEST_CASE("robots of the same world are neighbours, in order of their names, but no strangers",
          "[planner][blackboard]") {
  Blackboard board({{"r1", "w1"}, {"r2", "w1"}, {"r3", "w2"}, {"r4", "w1"}});
  board.Put(RobotState{.world = "w1", .robot = "r4", .cell = {4, 4}});
  board.Put(RobotState{.world = "w1", .robot = "r2", .cell = {2, 2}, .goals_left = {{1, 1}}});
  board.Put(RobotState{.world = "w2", .robot = "r3", .cell = {3, 3}});
  board.PutIntendedPath("r2", {{2, 1}});
  const auto before = board.version("r1");
  board.Put(RobotState{.world = "w1", .robot = "stranger"});
  CHECK(board.version("r1") == before);
  const auto neighbours = board.NeighboursOf("r1");
  REQUIRE(neighbours.size() == 2);
  CHECK(neighbours[0].robot == "r2");
  CHECK(neighbours[0].has_goals);
  CHECK(neighbours[0].path == std::vector<Cell>{{2, 1}});
  CHECK(neighbours[1].robot == "r4");
  CHECK_FALSE(neighbours[1].has_goals);
}

TEST_CASE("guidance made of a route does not replace what came in the meantime",
          "[planner][blackboard]") {
  using Stage = RouteStatus::Stage;
  Blackboard board(kOneRobot);
  const Position goal{2.0, 2.0};
  const Guidance made{
      .robot = "r1", .revision = 1, .path = {{1, 1}, {1, 2}}, .given_by = "goal_pose"};
  CHECK(board.RouteStatusOf("r1").number == 0);
  const std::uint64_t number = board.PutRoute("r1", {goal});
  CHECK(board.RouteStatusOf("r1").stage == Stage::kWaits);
  SECTION("nothing came") {
    board.ResolveRoute("r1", number, made);
    CHECK(board.Read("r1").guidance->given_by == "goal_pose");
    CHECK_FALSE(board.Read("r1").route.has_value());
    CHECK(board.RouteStatusOf("r1").stage == Stage::kTaken);
    CHECK(board.RouteStatusOf("r1").end == Cell{1, 2});
    SECTION("then the operator's own path") {
      board.Put(Guidance{.robot = "r1", .revision = 2, .given_by = "operator"});
      CHECK(board.RouteStatusOf("r1").stage == Stage::kReplaced);
      board.CancelRoute("r1", number);
      CHECK(board.Read("r1").guidance->given_by == "operator");
    }
    SECTION("then it is canceled") {
      board.CancelRoute("r1", number);
      CHECK(board.Read("r1").guidance->path.empty());
    }
    SECTION("then another one is canceled") {
      board.CancelRoute("r1", number + 1);
      CHECK_FALSE(board.Read("r1").guidance->path.empty());
    }
  }
  SECTION("it is refused") {
    board.ResolveRoute("r1", number, Fail(ErrorCode::kNotFound, "no path"));
    CHECK_FALSE(board.Read("r1").guidance.has_value());
    CHECK(board.RouteStatusOf("r1").stage == Stage::kRefused);
    CHECK(board.RouteStatusOf("r1").reason == "no path");
  }
  SECTION("the operator's own path") {
    board.Put(Guidance{.robot = "r1", .revision = 2, .given_by = "operator"});
    board.ResolveRoute("r1", number, made);
    CHECK(board.Read("r1").guidance->given_by == "operator");
    CHECK(board.RouteStatusOf("r1").stage == Stage::kReplaced);
  }
  SECTION("a newer route") {
    const std::uint64_t newer = board.PutRoute("r1", {{4.0, 4.0}});
    board.ResolveRoute("r1", number, made);
    CHECK_FALSE(board.Read("r1").guidance.has_value());
    CHECK(board.Read("r1").route->number == newer);
    CHECK(board.RouteStatusOf("r1").stage == Stage::kWaits);
  }
}

TEST_CASE("guidance goes with the belief of an operator service that restarted",
          "[planner][blackboard]") {
  Blackboard board(kOneRobot);
  board.Put(Belief{.world = "w1", .revision = 3});
  board.Put(Guidance{.robot = "r1", .revision = 4, .belief_revision = 3});
  board.Put(Belief{.world = "w1", .revision = 3});
  CHECK(board.Read("r1").guidance.has_value());
  board.Put(Belief{.world = "w1", .revision = 0});
  CHECK_FALSE(board.Read("r1").guidance.has_value());
}

TEST_CASE("a change wakes the robots near it that stand, a path that stays the same is none",
          "[planner][blackboard]") {
  Blackboard board({{"r1", "w1"}, {"r2", "w1"}, {"r3", "w1"}, {"r4", "w2"}, {"r5", "w1"}});
  board.Put(RobotState{.world = "w1", .robot = "r1", .cell = {1, 1}});
  board.Put(RobotState{.world = "w1", .robot = "r2", .cell = {1, 2}});
  board.Put(RobotState{.world = "w1", .robot = "r3", .cell = {30, 30}});
  board.Put(RobotState{.world = "w2", .robot = "r4", .cell = {1, 2}});
  board.Put(RobotState{
      .world = "w1", .robot = "r5", .cell = {2, 1}, .command_outcome = CommandOutcome::kRunning});
  board.PutIntendedPath("r1", {{1, 2}});
  std::map<std::string, std::uint64_t> seen;
  for (const char* robot : {"r1", "r2", "r3", "r4", "r5"}) seen[robot] = board.version(robot);
  board.PutIntendedPath("r1", {{1, 2}});
  CHECK(board.version("r2") == seen["r2"]);
  std::thread other([&] { board.PutIntendedPath("r1", {{1, 2}, {1, 3}}); });
  CHECK(board.WaitForChange("r2", seen["r2"], Clock::TimePoint::max()) != seen["r2"]);
  other.join();
  for (const char* robot : {"r1", "r3", "r4", "r5"}) CHECK(board.version(robot) == seen[robot]);
}
