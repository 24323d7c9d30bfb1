#include "planner/search/reward.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "unit/planner/search/text_map.h"

namespace conav::planner {
namespace {

/// With the paper's cost.
const RewardOptions kOptions{.communication_cost = 10.0};

TEST_CASE("each term by hand", "[planner][search]") {
  CHECK(EnvironmentReward(true, kOptions) == 100.0);
  CHECK(EnvironmentReward(false, kOptions) == -1.0);
  CHECK(GuidanceReward(true, true, 7) == 0.0);
  CHECK(GuidanceReward(true, false, 1) == 0.0);
  CHECK(GuidanceReward(true, false, 7) == Approx(-1.9459101));
  CHECK(GuidanceReward(false, false, 7) == 0.0);  // no path so far to be off from
  CHECK(SmoothnessReward(0) == 0.0);
  CHECK(SmoothnessReward(3) == -3.0);
}

TEST_CASE("a communication costs 10 and 1 per cell of the path not visited, or less in proportion",
          "[planner][search]") {
  CHECK(CommunicationCost(0, kOptions) == 10.0);
  CHECK(CommunicationCost(4, kOptions) == 14.0);
  RewardOptions cheap;
  cheap.communication_cost = 0.5;
  CHECK(CommunicationCost(0, cheap) == 0.5);
  CHECK(CommunicationCost(4, cheap) == Approx(0.7));
}

TEST_CASE("the reward of a move is the sum of its terms", "[planner][search]") {
  TextWorld world({"######", "#S..G#", "#....#", "######"});
  world.problem.guidance = {{1, 2}};
  PathState path(world.problem);
  path.Go(world.EdgeBetween({1, 1}, {1, 2}));
  CHECK(MoveTerms(path, kOptions).Sum() == Approx(-1.0 + 0.0 - 0.0 + 1.0));  // on the path, nearer
  path.Go(world.EdgeBetween({1, 2}, {2, 2}));
  CHECK(MoveTerms(path, kOptions).Sum() == Approx(-1.0 - std::log(3.0) - 0.0 - 1.0));
  path.Go(world.EdgeBetween({2, 2}, {2, 1}));
  path.Go(world.EdgeBetween({2, 1}, {1, 1}));
  CHECK(MoveTerms(path, kOptions).Sum() ==
        Approx(-1.0 - std::log(5.0) - 1.0 + 1.0));  // second visit
  RewardOptions paper = kOptions;
  paper.progress = 0.0;
  CHECK(MoveTerms(path, paper).Sum() == Approx(-1.0 - std::log(5.0) - 1.0));
}

TEST_CASE("a communication gives its information less its cost", "[planner][search]") {
  TextWorld world({"######", "#S..G#", "######"});
  world.problem.guidance = {{1, 1}, {1, 2}, {1, 3}, {1, 4}};
  const PathState path(world.problem);
  CHECK(RewardOfPicture(path, 0.0, 1.75, kOptions).Sum() == Approx(1.75 - 13.0));
  RewardOptions with_step = kOptions;
  with_step.communication_step = -1.0;
  CHECK(RewardOfPicture(path, 0.0, 1.75, with_step).Sum() == Approx(1.75 - 14.0));
  CHECK(RewardOfPicture(path, 0.0, 1.75, with_step).Terms() ==
        RewardTerms{.steps = -1.0, .information = 1.75, .communication = -13.0});
}

TEST_CASE("a view costs the turn away from where the robot looks", "[planner][search]") {
  TextWorld world({"#####", "#S.G#", "#...#", "#####"});
  world.problem.heading_rad = 0.5;
  PathState path(world.problem);
  RewardOptions options = kOptions;
  options.view_turn = 2.0;
  CHECK(TurnCost(path, 0.2, options) == Approx(0.6));
  CHECK(RewardOfPicture(path, 0.2, 0.0, options).Sum() == Approx(-10.0 - 0.6));
  path.Go(world.EdgeBetween({1, 1}, {2, 1}));  // south
  CHECK(TurnCost(path, 0.0, options) == Approx(std::numbers::pi));
  CHECK(TurnCost(path, std::numbers::pi, options) == Approx(std::numbers::pi));
  path.Stay();
  CHECK(TurnCost(path, -std::numbers::pi / 2.0, options) == Approx(0.0).margin(1e-12));
  path.Go(world.EdgeBetween({2, 1}, {2, 2}));
  CHECK(TurnCost(path, 0.0, options) == Approx(0.0).margin(1e-12));
  path.TakeBack(0);
  CHECK(TurnCost(path, 0.5, options) == Approx(0.0).margin(1e-12));
}

}  // namespace
}  // namespace conav::planner
