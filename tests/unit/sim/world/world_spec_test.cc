#include "sim/world/world_spec.h"

#include <catch2/catch.hpp>
#include <fstream>
#include <numbers>
#include <set>

#include "common/grid/geometry.h"
#include "common/grid/map_accuracy.h"
#include "sim/world/maze_presets.h"
#include "support/temporary_folder.h"

namespace conav::sim {
namespace {

std::string RefusalOf(const WorldOptions& options) {
  const Result<WorldSpec> result = MakeWorldSpec(options);
  return result ? "" : result.error().text;
}

/// A building of two rooms with no door between them: 3 x 8 cells, one pixel each.
class Building {
 public:
  Building() {
    Write("truth.pgm",
          "P2\n8 3\n255\n0 0 0 0 0 0 0 0\n0 254 254 254 0 254 254 0\n0 0 0 0 0 0 0 0\n");
    Write("plan.pgm",
          "P2\n8 3\n255\n0 0 0 0 0 0 0 0\n0 254 0 254 254 254 254 0\n0 0 0 0 0 0 0 0\n");
  }

  WorldOptions options() const {
    WorldOptions options;
    options.map_yaml = Header("truth");
    options.operator_map_yaml = Header("plan");
    options.cell_size_m = 1.0;
    options.goals_per_robot = 2;
    return options;
  }

 private:
  std::filesystem::path Write(const std::string& file, const std::string& text) const {
    std::ofstream(folder_ / file) << text;
    return folder_ / file;
  }
  std::filesystem::path Header(const std::string& name) const {
    return Write(name + ".yaml", "image: " + name +
                                     ".pgm\nresolution: 1.0\norigin: [0, 0, 0]\nnegate: 0\n"
                                     "occupied_thresh: 0.65\nfree_thresh: 0.196\n");
  }

  test::TemporaryFolder folder_;
};

TEST_CASE("seed S makes the maze of the paper's seed S", "[world]") {
  const WorldSpec spec = MakeWorldSpec({.seed = 234}).value();
  const Maze maze =
      GenerateMaze(FindMazePreset("conav13").value().options, 133003720, kFirstEpisodeGeneration);
  for (std::size_t i = 0; i < spec.truth.size(); ++i) {
    const bool wall = maze.entities.values()[i] == kMazeWall;
    CHECK((spec.truth.values()[i] == Occupancy::kOccupied) == wall);
    CHECK((spec.wall_classes.values()[i] >= '0' && spec.wall_classes.values()[i] <= '8') == wall);
  }
  CHECK(maze.entities[spec.starts[0]] == kMazeSpawn);
  REQUIRE(spec.goals[0].size() == 4);
  for (const Cell goal : spec.goals[0]) CHECK(maze.entities[goal] == kMazeObject);
  CHECK(spec.floor_classes == maze.variations);
}

TEST_CASE(
    "goals can be reached, starts and goals are different cells and free on the operator's "
    "map, which is wrong in 20 cells",
    "[world]") {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const WorldSpec spec = MakeWorldSpec({.seed = seed, .robots = 4}).value();
    std::set<Cell> cells(spec.starts.begin(), spec.starts.end());
    for (std::size_t robot = 0; robot < 4; ++robot) {
      const std::set<Cell> reachable = ReachableCells(spec.truth, spec.starts[robot]);
      for (const Cell goal : spec.goals[robot]) CHECK(reachable.contains(goal));
      cells.insert(spec.goals[robot].begin(), spec.goals[robot].end());
    }
    CHECK(cells.size() == 4 + 4 * 4);
    for (const Cell cell : cells) CHECK(spec.human_map[cell] == Occupancy::kFree);
    CHECK(CompareMaps(spec.truth, spec.human_map, ToBelief(spec.human_map)).wrong_at_first == 20);
  }
}

TEST_CASE("the same seed gives the same world, and robot 1 the same among more robots", "[world]") {
  const WorldSpec a = MakeWorldSpec({.robots = 3}).value();
  const WorldSpec b = MakeWorldSpec({.robots = 3}).value();
  CHECK(a.truth == b.truth);
  CHECK(a.human_map == b.human_map);
  CHECK(a.starts == b.starts);
  CHECK(a.goals == b.goals);
  const WorldSpec one = MakeWorldSpec({.robots = 1}).value();
  CHECK(one.starts[0] == a.starts[0]);
  CHECK(one.goals[0] == a.goals[0]);
}

TEST_CASE("shared goals are one list for all robots", "[world]") {
  const WorldSpec spec = MakeWorldSpec({.robots = 3, .shared_goals = true}).value();
  CHECK(spec.goals[0].size() == 4);
  CHECK(spec.goals == std::vector<std::vector<Cell>>(3, spec.goals[0]));
}

TEST_CASE("every preset makes a world with its number of goals, also of seeds beyond 32 bits",
          "[world]") {
  CHECK(MakeWorldSpec({.seed = 0x1'0000'0009}).value().truth !=
        MakeWorldSpec({.seed = 9}).value().truth);
  for (const MazePreset& preset : MazePresets()) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      INFO(preset.name << " seed " << seed);
      CHECK(MakeWorldSpec({.seed = seed, .preset = preset.name}).value().goals[0].size() ==
            static_cast<std::size_t>(preset.goals));
    }
  }
}

TEST_CASE("a building and its outdated plan make a world", "[world]") {
  const Building building;
  const WorldSpec spec = MakeWorldSpec(building.options()).value();
  CHECK(spec.cell_size_m == 1.0);
  CHECK(spec.truth[{1, 4}] == Occupancy::kOccupied);
  CHECK(spec.human_map[{1, 4}] == Occupancy::kFree);
  CHECK(spec.human_map[{1, 2}] == Occupancy::kOccupied);
  CHECK(spec.starts[0].column <= 3);  // the larger room
}

TEST_CASE("a building without a plan gets a corrupted one", "[world]") {
  const Building building;
  WorldOptions options = building.options();
  options.operator_map_yaml.clear();
  options.goals = {{1, 1}};
  options.starts = {{1, 2}};
  const WorldSpec spec = MakeWorldSpec(options).value();  // round(0.12 * 24) = 3 wrong cells
  CHECK(CompareMaps(spec.truth, spec.human_map, ToBelief(spec.human_map)).wrong_at_first == 3);
  CHECK(spec.human_map[{1, 1}] == Occupancy::kFree);
}

TEST_CASE("impossible worlds are refused by name and value", "[world]") {
  for (const auto& [options, names] : std::vector<std::pair<WorldOptions, const char*>>{
           {{.preset = "huge"}, "maze preset \"huge\""},
           {{.robots = 0}, "robots = 0"},
           {{.robots = 1000}, "1000"},
           {{.goals_per_robot = 99}, "of 99 of robot 1"},
           {{.wrong_share = 1.5}, "wrong_share = 1.5"},
           {{.map_yaml = "/none.yaml"}, "/none.yaml"},
           {{.operator_map_yaml = "plan.yaml"}, "plan.yaml"},
       }) {
    CHECK_THAT(RefusalOf(options), Catch::Contains(names));
  }
}

TEST_CASE("given starts and goals are taken, or refused by name", "[world]") {
  const Building building;
  WorldOptions options = building.options();
  options.goals = {{1, 1}, {1, 2}};
  for (options.seed = 1; options.seed <= 20; ++options.seed) {  // no start is drawn on a goal
    CHECK(MakeWorldSpec(options).value().starts == std::vector<Cell>{{1, 3}});
  }
  options.starts = {{1, 1}};
  options.goals = {{1, 3}};
  CHECK(MakeWorldSpec(options).value().goals == std::vector<std::vector<Cell>>{{{1, 3}}});
  for (const auto& [goals, names] : std::vector<std::pair<std::vector<Cell>, const char*>>{
           {{{1, 5}}, "goal (1,5)"},
           {{{1, 4}}, "goal (1,4)"},
           {{{1, 9}}, "goal (1,9)"},
           {{{1, 3}, {1, 3}}, "goal (1,3)"},
           {{{1, 3}, {1, 1}}, "start (1,1) of robot 1"},
       }) {
    options.goals = goals;
    CHECK_THAT(RefusalOf(options), Catch::StartsWith(names));
  }
  options.starts = {{1, 1}, {1, 2}};
  CHECK_THAT(RefusalOf(options), Catch::StartsWith("2 starts"));
}

constexpr auto kWall = Occupancy::kOccupied;

/// 3 x 4, a wall in the truth's north-west corner and one in the map's south-east corner.
WorldSpec SmallWorld() {
  WorldSpec spec;
  spec.truth = OccupancyGrid(3, 4, Occupancy::kFree);
  spec.truth[{0, 0}] = kWall;
  spec.human_map = OccupancyGrid(3, 4, Occupancy::kFree);
  spec.human_map[{2, 3}] = kWall;
  spec.wall_classes = Grid<char>(3, 4, '*');
  spec.wall_classes[{0, 3}] = '7';
  spec.floor_classes = Grid<char>(3, 4, '.');
  spec.floor_classes[{1, 1}] = 'A';
  spec.starts = {{1, 0}};
  spec.goals = {{{0, 1}, {2, 2}}};
  return spec;
}

TEST_CASE("A quarter turn takes the east side to the north", "[world]") {
  const WorldSpec turned = *Rotated(SmallWorld(), 90);
  REQUIRE(turned.truth.rows() == 4);
  REQUIRE(turned.truth.columns() == 3);
  CHECK(turned.truth[{3, 0}] == kWall);
  CHECK(turned.human_map[{0, 2}] == kWall);
  CHECK(turned.wall_classes[{0, 0}] == '7');
  CHECK(turned.floor_classes[{2, 1}] == 'A');
  CHECK(turned.starts == std::vector<Cell>{{3, 1}});
  CHECK(turned.goals == std::vector<std::vector<Cell>>{{{2, 0}, {1, 2}}});
  CHECK(turned.start_heading_rad == Approx(std::numbers::pi / 2));
}

TEST_CASE("Half a turn mirrors rows and columns, none changes nothing, other angles are refused",
          "[world]") {
  const WorldSpec world = SmallWorld();
  CHECK(Rotated(world, 0)->truth == world.truth);
  CHECK(Rotated(world, 0)->start_heading_rad == 0.0);
  const WorldSpec turned = *Rotated(world, 180);
  CHECK(turned.truth[{2, 3}] == kWall);
  CHECK(turned.goals == std::vector<std::vector<Cell>>{{{2, 2}, {0, 1}}});
  CHECK(Rotated(*Rotated(world, 90), 270)->truth == world.truth);
  for (const int angle : {-90, 45, 360}) {
    const auto refused = Rotated(world, angle);
    REQUIRE_FALSE(refused);
    CHECK_THAT(refused.error().text, Catch::StartsWith(fmt::format("rotation_deg = {}", angle)));
  }
}

TEST_CASE("a turned world is the same world, turned as a whole", "[world]") {
  const WorldSpec world = MakeWorldSpec({.seed = 234}).value();
  const WorldSpec turned = MakeWorldSpec({.seed = 234, .rotation_deg = 90}).value();
  const WorldSpec expected = Rotated(world, 90).value();
  CHECK(turned.truth == expected.truth);
  CHECK(turned.human_map == expected.human_map);
  CHECK(turned.starts == expected.starts);
  CHECK(turned.goals == expected.goals);
}

TEST_CASE("doors close on the first robot's way and leave a way to every goal", "[world]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    WorldOptions options{.seed = seed, .preset = "open21", .robots = 2, .closing_doors = 2};
    const WorldSpec world = MakeWorldSpec(options).value();
    REQUIRE(world.doors.size() == 2);
    OccupancyGrid closed = world.truth;
    const Grid<int> open_steps = StepsFrom(RoomFor(world.truth, 0.0), world.starts[0]);
    for (const Door& door : world.doors) {
      CHECK(world.truth[door.cell] == Occupancy::kFree);
      CHECK_FALSE(Contains(world.starts, door.cell));
      CHECK(2 * door.after_moves + 1 >= open_steps[door.cell]);  // half-way there on the tour
      closed[door.cell] = Occupancy::kOccupied;
    }
    const Grid<std::uint8_t> room = RoomFor(closed, 0.0);
    for (std::size_t robot = 0; robot < 2; ++robot) {
      const Grid<int> steps = StepsFrom(room, world.starts[robot]);
      for (const Cell goal : world.goals[robot]) CHECK(steps[goal] > 0);
    }
    options.rotation_deg = 90;
    const Cell turned = MakeWorldSpec(options).value().doors[0].cell;
    const Cell door = world.doors[0].cell;
    CHECK(turned == Cell{world.truth.columns() - 1 - door.column, door.row});
  }
  WorldOptions open{.preset = std::string(kWaterwayPreset), .closing_doors = 1};
  CHECK_THAT(MakeWorldSpec(open).error().text, Catch::Contains("no doors"));
}

}  // namespace
}  // namespace conav::sim
