#include "sim/physics/world_model.h"

#include <mujoco/mujoco.h>

#include <catch2/catch.hpp>
#include <limits>

#include "unit/sim/physics/mazes.h"

namespace conav::sim {
namespace {

using Catch::Matchers::Contains;
using test::MakeWorld;

TEST_CASE("a maze compiles into a model with the options of MemoryMaze", "[sim][physics]") {
  const auto model = BuildModel(MakeWorld(test::kMaze));
  REQUIRE(model);
  CHECK((*model)->nu == 2);
  CHECK((*model)->nv == 5);
  CHECK((*model)->ncam == 1);
  CHECK((*model)->opt.timestep == 0.005);
  CHECK((*model)->opt.cone == mjCONE_ELLIPTIC);
  CHECK((*model)->opt.noslip_iterations == 5);
  CHECK((*model)->cam_fovy[0] == Approx(80.0));
}

TEST_CASE("maps that are not square, open, tiny or large compile", "[sim][physics]") {
  CHECK(BuildModel(MakeWorld(test::kWideMaze)));
  CHECK(BuildModel(MakeWorld({"..", ".."}, {0, 0})));
  CHECK(BuildModel(MakeWorld({"."}, {0, 0})));
  CHECK(BuildModel(MakeWorld(test::Rows(60, std::string(90, '.')), {5, 5}, 1.0)));
}

TEST_CASE("a world without texture classes compiles", "[sim][physics]") {
  PhysicsWorld world = MakeWorld(test::kMaze);
  world.wall_classes = {};
  world.floor_classes = {};
  CHECK(BuildModel(world));
}

TEST_CASE("any robot name is legal in the model", "[sim][physics]") {
  PhysicsWorld world = MakeWorld(test::kMaze);
  world.robots[0].name = R"(a "b" <c/> & d)";
  CHECK(BuildModel(world));
}

TEST_CASE("what is wrong with a world is named", "[sim][physics]") {
  PhysicsWorld world = MakeWorld(test::kMaze);
  const auto error = [&world] {
    const auto model = BuildModel(world);
    return model ? std::string("no error") : model.error().text;
  };
  SECTION("cells too small") {
    world.cell_size_m = 0.5;
    CHECK_THAT(error(), Contains("cell size 0.5 m is too small"));
  }
  SECTION("cell size not a number") {
    world.cell_size_m = std::numeric_limits<double>::quiet_NaN();
    CHECK_THAT(error(), Contains("cell size nan m"));
  }
  SECTION("no map") {
    world.truth = {};
    CHECK_THAT(error(), Contains("map of 0x0 cells"));
  }
  SECTION("unknown cell") {
    world.truth[{3, 4}] = Occupancy::kUnknown;
    CHECK_THAT(error(), Contains("(3,4) of the true map is unknown"));
  }
  SECTION("texture classes of another size") {
    world.wall_classes = Grid<char>(2, 3, 'a');
    CHECK_THAT(error(), Contains("texture classes of 2x3 cells for a map of 13x13"));
  }
  SECTION("no robot") {
    world.robots.clear();
    CHECK_THAT(error(), Contains("0 robots"));
  }
  SECTION("robot in a wall") {
    world.robots[0].start = {0, 0};
    CHECK_THAT(error(), Contains("robot r1 at (0,0) is inside of a wall"));
  }
  SECTION("robot outside") {
    world.robots[0].start = {13, 1};
    CHECK_THAT(error(), Contains("robot r1 at (13,1) lies outside of the 13x13 map"));
  }
  SECTION("two robots in one cell") {
    world.robots.push_back({"r2", {1, 1}, 0.0});
    CHECK_THAT(error(), Contains("two robots start at cell (1,1)"));
  }
  SECTION("two robots of one name") {
    world.robots.push_back({"r1", {1, 2}, 0.0});
    CHECK_THAT(error(), Contains("two robots are named r1"));
  }
  SECTION("goal in a wall") {
    world.goals.push_back({{0, 5}, 0});
    CHECK_THAT(error(), Contains("goal 0 at (0,5) is inside of a wall"));
  }
}

}  // namespace
}  // namespace conav::sim
