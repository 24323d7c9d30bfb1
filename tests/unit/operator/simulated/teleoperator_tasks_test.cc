#include <catch2/catch.hpp>

#include "operator/simulated/synthetic_teleoperator.h"
#include "unit/operator/support/drawn_map.h"

namespace conav::operators {
namespace {

TEST_CASE("a robot in the way makes room where there is some", "[simulated]") {
  struct Row {
    const char* rule;
    std::vector<std::string> map;
    int from, to, blocker;  // columns of row 1
    std::set<Cell> walls, robots;
    std::vector<DriveTask> tasks;
  };
  const std::vector<std::string> fork{"#######", "#     #", "# #### ", "### ###"};
  for (const Row& row : std::vector<Row>{
           {"to the nearest cell next to the path",
            {"#######", "#     #", "#### ##", "#######"},
            1,
            5,
            3,
            {},
            {},
            {{"r2", {2, 4}}}},
           {"a robot that is shut in in a dead end is let out first",
            {"#######", "#     #", "# #####", "#######"},
            2,
            5,
            5,
            {},
            {},
            {{"r1", {2, 1}}, {"r2", {1, 1}}}},
           {"there is none", {"#####", "#   #", "#####"}, 1, 3, 2, {}, {}, {}},
           {"certain walls and other robots are none", fork, 1, 3, 2, {{1, 4}}, {{2, 1}}, {}},
       }) {
    CAPTURE(row.rule);
    std::vector<Cell> path;
    for (int column = row.from; column <= row.to; ++column) path.push_back({1, column});
    CHECK(MakeRoom({DrawnMap(row.map),
                    row.walls,
                    "r1",
                    {1, row.from},
                    path,
                    "r2",
                    {1, row.blocker},
                    row.robots}) == row.tasks);
  }
}

}  // namespace
}  // namespace conav::operators
