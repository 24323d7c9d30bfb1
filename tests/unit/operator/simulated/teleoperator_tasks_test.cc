#include <catch2/catch.hpp>

#include "operator/simulated/synthetic_teleoperator.h"
#include "support/drawn_map.h"

namespace conav::operators {
namespace {

TEST_CASE("a robot in the way makes room where there is some", "[simulated]") {
  struct Row {
    const char* rule;
    std::vector<std::string> map;  // row 1: r1, r2 and, where r1 wants to pass it, the path's end
    std::set<Cell> walls, robots;
    std::vector<DriveTask> tasks;
  };
  for (const Row& row : std::vector<Row>{
           {"to the nearest cell next to the path",
            {"#######", "#1 2 x#", "#### ##", "#######"},
            {},
            {},
            {{"r2", {2, 4}}}},
           {"a robot that is shut in in a dead end is let out first",
            {"#######", "# 1  2#", "# #####", "#######"},
            {},
            {},
            {{"r1", {2, 1}}, {"r2", {1, 1}}}},
           {"there is none", {"#####", "#12x#", "#####"}, {}, {}, {}},
           {"certain walls and other robots are none",
            {"#######", "#12x  #", "# #### ", "### ###"},
            {{1, 4}},
            {{2, 1}},
            {}},
       }) {
    CAPTURE(row.rule);
    const auto column = [&](char drawn) { return static_cast<int>(row.map[1].find(drawn)); };
    const Cell start{1, column('1')}, blocker{1, column('2')};
    std::vector<Cell> path;
    for (int to = start.column; to <= std::max(blocker.column, column('x')); ++to) {
      path.push_back({1, to});
    }
    CHECK(MakeRoom({DrawnMap(row.map), row.walls, "r1", start, path, "r2", blocker, row.robots}) ==
          row.tasks);
  }
}

}  // namespace
}  // namespace conav::operators
