#include <catch2/catch.hpp>

#include "planner/methods/ig_mcts_method.h"

namespace conav::planner {
namespace {

/// An open room of 3 x 5 cells of which the robot has seen three; the operator's path leads through it
/// from left to right.
Situation InARoom() {
  Situation situation;
  situation.state.cell = {2, 1};
  situation.state.goals_left = {{2, 5}};
  situation.map.cells = OccupancyGrid(5, 7, Occupancy::kUnknown);
  for (const int column : {1, 2, 3}) situation.map.cells[{2, column}] = Occupancy::kFree;
  situation.belief.wall_probability = BeliefGrid(5, 7, 0.0F);
  situation.guidance = Guidance{.path = {{2, 1}, {2, 2}, {2, 3}, {2, 4}, {2, 5}}};
  situation.guided_before = true;
  return situation;
}

SituationProblem ProblemOf(const Situation& situation, bool blocked_path_guides) {
  return {situation,
          situation.belief.wall_probability,
          {},
          ViewsFor(situation, 8),
          {.blocked_path_guides = blocked_path_guides}};
}

TEST_CASE("a path guides as long as nothing is known to stand in it", "[planner][decision]") {
  const SituationProblem problem = ProblemOf(InARoom(), false);
  CHECK(problem.get()->guidance.size() == 5);
  CHECK(problem.get()->guided_before);
}

TEST_CASE("a path through a wall that the robot knows of counts as none, unless it shall guide",
          "[planner][decision]") {
  Situation situation = InARoom();
  situation.map.cells[{2, 4}] = Occupancy::kOccupied;
  const SituationProblem none = ProblemOf(situation, false);
  CHECK(none.get()->guidance.empty());
  CHECK_FALSE(none.get()->guided_before);
  const SituationProblem kept = ProblemOf(situation, true);
  CHECK(kept.get()->guidance.size() == 5);
  CHECK(kept.get()->guided_before);
}

TEST_CASE("a path that was withdrawn is still missed", "[planner][decision]") {
  Situation situation = InARoom();
  situation.guidance.reset();
  CHECK(ProblemOf(situation, false).get()->guided_before);
}

}  // namespace
}  // namespace conav::planner
