#include "planner/search/path_state.h"

#include <catch2/catch.hpp>

#include "support/steps_to_goals.h"
#include "unit/planner/search/text_map.h"

namespace conav::planner {
namespace {

TEST_CASE("tau counts its length, visits and the guidance that is left", "[planner][search]") {
  TextWorld world({"######", "#S..G#", "#....#", "######"});
  world.problem.guidance = {{1, 1}, {1, 2}, {1, 3}, {1, 4}};
  PathState path(world.problem);
  CHECK(path.length() == 1);
  CHECK(path.earlier_visits() == 0);
  CHECK(path.on_guidance());
  CHECK(path.unvisited_guidance() == 3);

  path.Go(world.EdgeBetween({1, 1}, {1, 2}));
  CHECK(path.length() == 2);
  CHECK(path.unvisited_guidance() == 2);
  path.Go(world.EdgeBetween({1, 2}, {2, 2}));
  CHECK_FALSE(path.on_guidance());
  path.Go(world.EdgeBetween({2, 2}, {1, 2}));
  CHECK(path.earlier_visits() == 1);
  path.Stay();
  CHECK(path.earlier_visits() == 2);
  CHECK(path.length() == 5);
  CHECK(path.unvisited_guidance() == 2);
}

TEST_CASE("taking steps back restores everything", "[planner][search]") {
  TextWorld world({"######", "#S?.G#", "######"});
  world.problem.guidance = {{1, 2}, {1, 4}};
  PathState path(world.problem);
  const PathState::SetKey before = path.set_key();
  const Edge edge = world.EdgeBetween({1, 1}, {1, 2});
  path.Go(edge);
  path.Stay();
  CHECK(path.IsKnownFree(edge));
  CHECK(path.set_key() != before);
  path.TakeBack(0);
  CHECK(path.vertex() == world.problem.start);
  CHECK(path.length() == 1);
  CHECK(path.unvisited_guidance() == 2);
  CHECK_FALSE(path.IsKnownFree(edge));
  CHECK(path.set_key() == before);
}

TEST_CASE("the path since the last picture is part of tau", "[planner][search]") {
  TextWorld world({"#####", "#..S#", "#####"});
  world.problem.path = {{1, 1}, {1, 2}, {1, 1}, {1, 2}, {1, 3}};
  world.problem.guidance = {{1, 1}, {1, 3}};
  PathState path(world.problem);
  CHECK(path.length() == 5);
  CHECK(path.visits(world.At(1, 1)) == 2);
  CHECK(path.unvisited_guidance() == 0);
  path.Go(world.EdgeBetween({1, 3}, {1, 2}));
  CHECK(path.earlier_visits() == 2);
}

TEST_CASE("a goal on which the robot stands counts as reached, one in a wall does not count",
          "[planner][search]") {
  TextWorld world({"####", "#SG#", "####"});
  world.problem.goals_left = {{1, 1}, {0, 0}, {1, 2}, {1, 2}};
  PathState path(world.problem);
  CHECK_FALSE(path.at_goal());
  CHECK(path.goals_left() == 1);
  path.Go(world.EdgeBetween({1, 1}, {1, 2}));
  CHECK(path.at_goal());
}

TEST_CASE("guidance through walls stays unvisited, each cell once", "[planner][search]") {
  TextWorld world({"#####", "#S#G#", "#####"});
  world.problem.guidance = {{1, 1}, {1, 2}, {1, 3}, {1, 2}};
  CHECK(PathState(world.problem).unvisited_guidance() == 2);
}

TEST_CASE("progress is the number of steps to the nearest goal that are saved",
          "[planner][search]") {
  TextWorld world({"######", "#.S?G#", "######"});
  PathState path(world.problem);
  CHECK(path.progress() == 0.0);
  path.Go(world.EdgeBetween({1, 2}, {1, 1}));
  CHECK(path.progress() == -1.0);
  path.TakeBack(0);
  path.Go(world.EdgeBetween({1, 2}, {1, 3}));
  CHECK(path.progress() == 2.0);  // an unknown cell is two expected steps
  path.Stay();
  CHECK(path.progress() == 0.0);
}

TEST_CASE("steps lead to the nearest goal around walls, unknown cells count twice",
          "[planner][search]") {
  const TextWorld world({"#######", "#S.#.G#", "#..#..#", "#..?..#", "#######"});
  const auto steps = test::StepsToNearestGoal(world.problem);
  const auto at = [&](int row, int column) {
    return steps[static_cast<std::size_t>(world.At(row, column))];
  };
  CHECK(at(1, 5) == 0.0);
  CHECK(at(2, 4) == 2.0);
  CHECK(at(3, 3) == 4.0);  // the unknown cell itself: leaving it is certain
  CHECK(at(3, 2) == 6.0);  // entering it is not
  CHECK(at(1, 1) == 9.0);
}

TEST_CASE("where nothing was seen yet, steps may count more that lead through the operator's walls",
          "[planner][search]") {
  TextWorld world({"#######", "#S.?.G#", "#######"}, {"#######", "#..#..#", "#######"});
  const auto from_start = [&] {
    return test::StepsToNearestGoal(world.problem)[static_cast<std::size_t>(world.problem.start)];
  };
  CHECK(from_start() == 5.0);
  world.problem.believed_wall_steps = 10;
  CHECK(from_start() == 3.0 + 2.0 * 10.0);
  TextWorld open({"#######", "#S.?.G#", "#######"});  // the operator takes it for free
  open.problem.believed_wall_steps = 10;
  CHECK(test::StepsToNearestGoal(open.problem)[static_cast<std::size_t>(open.problem.start)] ==
        5.0);
}

TEST_CASE("the way to the goal may be the operator's, though it is longer", "[planner][search]") {
  // Round the block: 4 steps by the north, 8 by the south.
  TextWorld world({"#######", "#S...G#", "#.###.#", "#.....#", "#######"});
  world.problem.guidance = {{2, 1}, {3, 1}, {3, 2}, {3, 3}, {3, 4}, {3, 5}, {2, 5}, {1, 5}};
  const auto at = [&](int row, int column) {
    return test::StepsToNearestGoal(world.problem)[static_cast<std::size_t>(world.At(row, column))];
  };
  CHECK(at(1, 1) == 4.0);
  world.problem.off_guidance_steps = 3;
  CHECK(at(1, 1) == 8.0);
  CHECK(at(1, 2) == 3.0 + 3.0 + 1.0);  // two steps off the path, then the goal, which is on it
  world.problem.guidance.clear();
  CHECK(at(1, 1) == 4.0);
}

TEST_CASE("where no goal can be reached every place is alike, without goals all steps are 0",
          "[planner][search]") {
  TextWorld world({"#####", "#S#G#", "#.#.#", "#####"});
  auto steps = test::StepsToNearestGoal(world.problem);
  CHECK(steps[static_cast<std::size_t>(world.At(1, 1))] == 2.0);  // the farthest is 1 away
  CHECK(steps[static_cast<std::size_t>(world.At(2, 1))] == 2.0);
  world.problem.goals_left.clear();
  for (const double none : test::StepsToNearestGoal(world.problem)) CHECK(none == 0.0);
}

}  // namespace
}  // namespace conav::planner
