#include "sim/physics/world_model.h"

#include <mujoco/mujoco.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "unit/sim/physics/mazes.h"

namespace conav::sim {
namespace {

using test::MakeWorld;

TEST_CASE("a maze compiles into a model with the options of MemoryMaze", "[physics]") {
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

TEST_CASE("maps that are not square, open, tiny or large, without classes, with odd names compile",
          "[physics]") {
  CHECK(BuildModel(MakeWorld(test::kWideMaze)));
  CHECK(BuildModel(MakeWorld({"..", ".."}, {0, 0})));
  CHECK(BuildModel(MakeWorld({"."}, {0, 0})));
  CHECK(BuildModel(MakeWorld(test::Rows(60, std::string(90, '.')), {5, 5}, 1.0)));
  PhysicsWorld world = MakeWorld(test::kMaze);
  world.wall_classes = {};
  world.floor_classes = {};
  world.robots[0].name = R"(a "b" <c/> & d)";
  CHECK(BuildModel(world));
}

TEST_CASE("a mistake in a world is named", "[physics]") {
  using World = PhysicsWorld;
  const std::pair<const char*, void (*)(World&)> rows[] = {
      {"cell size 0.5 m", [](World& w) { w.cell_size_m = 0.5; }},
      {"cell size nan m", [](World& w) { w.cell_size_m = NAN; }},
      {"map of 0x0 cells", [](World& w) { w.truth = {}; }},
      {"(3,4) of the true map", [](World& w) { w.truth.values()[43] = Occupancy::kUnknown; }},
      {"2x3 cells for a map of 13x13", [](World& w) { w.wall_classes = Grid<char>(2, 3, 'a'); }},
      {"0 robots", [](World& w) { w.robots.clear(); }},
      {"robot r1 at (0,1)", [](World& w) { w.robots[0].start.row = 0; }},
      {"robot r1 at (13,1)", [](World& w) { w.robots[0].start.row = 13; }},
      {"cell (1,1)", [](World& w) { w.robots.resize(2, w.robots[0]), w.robots[1].name = "r2"; }},
      {"named r1", [](World& w) { w.robots.resize(2, w.robots[0]), w.robots[1].start.column = 2; }},
      {"goal 0 at (0,0)", [](World& w) { w.goals.resize(1); }},
  };
  for (const auto& [names, spoil] : rows) {
    PhysicsWorld world = MakeWorld(test::kMaze);
    spoil(world);
    const auto model = BuildModel(world);
    REQUIRE_FALSE(model);
    CHECK_THAT(model.error().text, Catch::Contains(names));
  }
}

}  // namespace
}  // namespace conav::sim
