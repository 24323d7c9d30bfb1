#include <catch2/catch.hpp>

#include "operator/simulated/synthetic_teleoperator.h"
#include "unit/operator/support/drawn_map.h"

namespace conav::operators {
namespace {

const std::set<Cell> kNone;

std::vector<Cell> Corridor(int from, int to) {
  std::vector<Cell> path;
  for (int column = from; column <= to; ++column) path.push_back({1, column});
  return path;
}

TEST_CASE("a robot on the path goes to the nearest cell next to it", "[simulated]") {
  const BeliefGrid map = DrawnMap({"#######", "#     #", "#### ##", "#######"});
  const Meeting meeting{map, kNone, "r1", {1, 1}, Corridor(1, 5), "r2", {1, 3}, {}};
  CHECK(MakeRoom(meeting) == std::vector<DriveTask>{{"r2", {2, 4}}});
}

TEST_CASE("a robot that is shut in is let out first", "[simulated]") {
  const BeliefGrid map = DrawnMap({"#######", "#     #", "# #####", "#######"});
  // r1 comes from the west and wants to the dead end in the east, where r2 stands.
  const Meeting meeting{map, kNone, "r1", {1, 2}, Corridor(2, 5), "r2", {1, 5}, {}};
  CHECK(MakeRoom(meeting) == std::vector<DriveTask>{{"r1", {2, 1}}, {"r2", {1, 1}}});
}

TEST_CASE("where there is no room nothing is asked for", "[simulated]") {
  const BeliefGrid narrow = DrawnMap({"#####", "#   #", "#####"});
  CHECK(MakeRoom({narrow, kNone, "r1", {1, 1}, Corridor(1, 3), "r2", {1, 2}, {}}).empty());
  // Walls known for certain and other robots are no room.
  const BeliefGrid map = DrawnMap({"#######", "#     #", "# #### ", "### ###"});
  const std::set<Cell> walls{{1, 4}};
  CHECK(MakeRoom({map, walls, "r1", {1, 1}, Corridor(1, 3), "r2", {1, 2}, {{2, 1}}}).empty());
}

}  // namespace
}  // namespace conav::operators
