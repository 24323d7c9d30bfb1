#include <catch2/catch.hpp>

#include "common/runtime/file.h"
#include "launcher/demo_plan.h"
#include "support/temporary_folder.h"

namespace conav::launcher {
namespace {

std::string Refusal(const DemoOptions& options) {
  const auto checked = CheckWorlds(options);
  return checked ? "" : checked.error().text;
}

TEST_CASE("worlds with room for their robots are accepted", "[launcher][world]") {
  DemoOptions options;
  CHECK(Refusal(options).empty());
  options.robots = 8;
  options.worlds = 3;
  CHECK(Refusal(options).empty());
}

TEST_CASE("a preset that there is not is refused, with those that there are", "[launcher][world]") {
  DemoOptions options;
  options.preset = "nope";
  CHECK_THAT(Refusal(options),
             Catch::StartsWith("--preset nope: maze preset \"nope\" is unknown") &&
                 Catch::Contains("conav13_inner"));
}

TEST_CASE("more robots than a world has room for are refused, with how many there is",
          "[launcher][world]") {
  DemoOptions options;
  options.robots = 24;
  CHECK(Refusal(options) ==
        "--robots 24: the world of seed 1 has room for 18; with 24, goal 1 of 4 of robot 18 has no "
        "place: no free cell is left");
  options.robots = 18;
  CHECK(Refusal(options).empty());
  options.robots = 24;
  options.shared_goals = true;
  CHECK(Refusal(options).empty());
}

TEST_CASE("every world of a run is looked at, from the seed of its own", "[launcher][world]") {
  DemoOptions options;
  options.robots = 18;
  options.maze_seed = 1;
  REQUIRE(Refusal(options).empty());
  options.worlds = 16;
  CHECK_THAT(Refusal(options), Catch::Contains("--robots 18: the world of seed "));
}

TEST_CASE("a map that is none is refused by its own name", "[launcher][world]") {
  const test::TemporaryFolder folder;
  DemoOptions options;
  options.map = folder / "plan.yaml";
  REQUIRE(WriteFile(options.map, "hello"));
  CHECK(Refusal(options) == options.map.string() + ": is no map_server file: no keys");
}

}  // namespace
}  // namespace conav::launcher
