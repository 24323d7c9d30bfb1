#include <catch2/catch.hpp>

#include "planner/search/path_state.h"
#include "unit/planner/search/text_map.h"

namespace conav::planner {
namespace {

TEST_CASE("steps lead to the nearest goal around walls, unknown cells count twice",
          "[planner][search]") {
  const TextWorld world({"#######", "#S.#.G#", "#..#..#", "#..?..#", "#######"});
  const auto steps = StepsToNearestGoal(world.problem);
  const auto at = [&](int row, int column) {
    return steps[static_cast<std::size_t>(world.At(row, column))];
  };
  CHECK(at(1, 5) == 0.0);
  CHECK(at(2, 4) == 2.0);
  CHECK(at(3, 3) == 4.0);  // the unknown cell itself: leaving it is certain
  CHECK(at(3, 2) == 6.0);  // entering it is not
  CHECK(at(1, 1) == 9.0);
}

TEST_CASE("where no goal can be reached every place is alike", "[planner][search]") {
  const TextWorld world({"#####", "#S#G#", "#.#.#", "#####"});
  const auto steps = StepsToNearestGoal(world.problem);
  CHECK(steps[static_cast<std::size_t>(world.At(1, 1))] == 2.0);  // the farthest is 1 away
  CHECK(steps[static_cast<std::size_t>(world.At(2, 1))] == 2.0);
}

TEST_CASE("without goals all steps are 0", "[planner][search]") {
  const TextWorld world({"###", "#S#", "###"});
  for (const double steps : StepsToNearestGoal(world.problem)) CHECK(steps == 0.0);
}

}  // namespace
}  // namespace conav::planner
