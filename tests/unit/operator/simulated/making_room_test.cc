#include <catch2/catch.hpp>

#include "operator/simulated/teleoperator_tasks.h"
#include "unit/operator/support/drawn_map.h"

using namespace conav;
using namespace conav::operators;

namespace {

const std::set<Cell> kNoCells;

std::vector<Cell> Corridor(int from, int to) {
  std::vector<Cell> path;
  for (int column = from; column <= to; ++column) path.push_back({1, column});
  return path;
}

}  // namespace

TEST_CASE("who stands on the path goes to the nearest cell beside it", "[operator][teleoperator]") {
  const BeliefGrid map = DrawnMap({"#######", "#     #", "#### ##", "#######"});
  const Meeting meeting{map, kNoCells, "r1", {1, 1}, Corridor(1, 5), "r2", {1, 3}, {}};
  CHECK(MakeRoom(meeting) == std::vector<DriveTask>{{"r2", {2, 4}}});
}

TEST_CASE("who is shut in is let out first", "[operator][teleoperator]") {
  const BeliefGrid map = DrawnMap({"#######", "#     #", "# #####", "#######"});
  // r1 comes from the west and wants to the dead end in the east, where r2 stands.
  const Meeting meeting{map, kNoCells, "r1", {1, 2}, Corridor(2, 5), "r2", {1, 5}, {}};
  const std::vector<DriveTask> tasks = MakeRoom(meeting);
  REQUIRE(tasks.size() == 2);
  CHECK(tasks[0].robot == "r1");
  CHECK(tasks[0].cell == Cell{2, 1});
  CHECK(tasks[1] == DriveTask{"r2", {1, 1}});
}

TEST_CASE("where there is no room nothing is asked for", "[operator][teleoperator]") {
  const BeliefGrid map = DrawnMap({"#####", "#   #", "#####"});
  const Meeting meeting{map, kNoCells, "r1", {1, 1}, Corridor(1, 3), "r2", {1, 2}, {}};
  CHECK(MakeRoom(meeting).empty());
}

TEST_CASE("walls known for certain and other robots are no room", "[operator][teleoperator]") {
  const BeliefGrid map = DrawnMap({"#######", "#     #", "# #### ", "### ###"});
  const std::set<Cell> walls{{1, 4}};
  const Meeting meeting{map, walls, "r1", {1, 1}, Corridor(1, 3), "r2", {1, 2}, {{2, 1}}};
  CHECK(MakeRoom(meeting).empty());
}
