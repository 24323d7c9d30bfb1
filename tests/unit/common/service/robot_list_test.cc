#include "common/service/robot_list.h"

#include <catch2/catch.hpp>

namespace conav {
namespace {

TEST_CASE("a list of world/robot becomes the world of each robot", "[service]") {
  CHECK(WorldOfRobot("planner", {"w1/r1", "w1/r2", "Lab_2/r3"}) ==
        std::map<std::string, std::string>{{"r1", "w1"}, {"r2", "w1"}, {"r3", "Lab_2"}});
}

TEST_CASE("entries that no sim would serve are refused", "[service]") {
  const std::string entry = GENERATE(as<std::string>(), "", "r1", "/r1", "w1/", "w1/r1/x", "w1/r-1",
                                     "w 1/r1", "w1/" + std::string(65, 'r'));
  CAPTURE(entry);
  CHECK_THROWS_WITH(WorldOfRobot("planner", {"w1/r1", entry}),
                    Catch::StartsWith("planner.robots: '" + entry + "'"));
}

TEST_CASE("a robot twice and no robots are refused", "[service]") {
  CHECK_THROWS_WITH(WorldOfRobot("operator", {"w1/r1", "w2/r1"}),
                    Catch::StartsWith("operator.robots: robot 'r1'"));
  CHECK_THROWS_WITH(WorldOfRobot("operator", {}), "operator.robots: no robots");
  CHECK(WorldOfRobot("operator", {}, NoRobots::kAllowed).empty());
}

}  // namespace
}  // namespace conav
