#include "operator/simulated/snapshot_reader.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "unit/operator/support/synthetic_fixture.h"

namespace conav::operators {
namespace {

using Edits = std::vector<CellEdit>;

SnapshotReaderParameters UnlimitedReader() {
  SnapshotReaderParameters parameters = FlawlessReader();
  parameters.edit_limit = 1000;
  return parameters;
}

/// UnlimitedReader() with one value of its own.
SnapshotReaderParameters With(double SnapshotReaderParameters::*field, double value) {
  SnapshotReaderParameters parameters = UnlimitedReader();
  parameters.*field = value;
  return parameters;
}

/// A corridor of the cells (1,1) to (1,8), with walls in it.
BeliefGrid WithWallAt(const std::vector<Cell>& walls) {
  BeliefGrid map = DrawnMap({"##########", "#        #", "##########"});
  for (const Cell wall : walls) map[wall] = 1.0F;
  return map;
}

/// From (1,1) to the east down the corridor.
Snapshot LookEast(VisibleCells visible) {
  return {.cell = {1, 1}, .visible = std::move(visible), .path = {{1, 1}}};
}

/// How often the reader edits `cell` in `tries` looks at the same picture.
double Rate(const SnapshotReaderParameters& parameters, const BeliefGrid& belief,
            const Snapshot& snapshot, Cell cell, int tries = 4000) {
  SnapshotReader reader(parameters, 7);
  int edited = 0;
  for (int i = 0; i < tries; ++i) {
    for (const CellEdit& edit : reader.Read(belief, snapshot, {})) edited += edit.cell == cell;
  }
  return static_cast<double>(edited) / tries;
}

TEST_CASE("A flawless reader edits every difference between picture and map, and nothing else",
          "[simulated]") {
  SnapshotReader reader(UnlimitedReader(), 1);
  const Snapshot snapshot = LookEast({{{1, 1}, {1, 2}, {1, 3}, {1, 4}}, {{0, 4}, {1, 5}}});
  CHECK(reader.Read(WithWallAt({{1, 3}}), snapshot, {}) == Edits{{{1, 3}, false}, {{1, 5}, true}});
  CHECK(reader.Read(WithWallAt({{1, 5}}), snapshot, {}).empty());
}

TEST_CASE("Walls on the path of the robot are removed, seen or not", "[simulated]") {
  const BeliefGrid belief = WithWallAt({{1, 2}});
  Snapshot snapshot = LookEast({});
  snapshot.cell = {1, 3};
  snapshot.path = {{1, 1}, {1, 2}, {1, 3}};
  CHECK(SnapshotReader(UnlimitedReader(), 1).Read(belief, snapshot, {}) == Edits{{{1, 2}, false}});
}

TEST_CASE("The border, certain cells and cells outside of the map are never edited",
          "[simulated]") {
  BeliefGrid belief = DrawnMap({"    ", "    ", "    ", "    "});
  Snapshot snapshot = LookEast({{}, {{0, 1}, {1, 3}, {3, 3}, {2, 2}, {9, 9}, {-1, 0}}});
  SnapshotReader reader(With(&SnapshotReaderParameters::guess_probability, 1.0), 3);
  for (int i = 0; i < 500; ++i) {
    for (const CellEdit& edit : reader.Read(belief, snapshot, {{2, 2}})) {
      CHECK(belief.Contains(edit.cell));
      CHECK_FALSE(belief.OnBorder(edit.cell));
      CHECK(edit.cell != Cell{2, 2});
    }
  }
}

TEST_CASE("No wall is put where the robot is or was", "[simulated]") {
  const Snapshot snapshot = LookEast({{{1, 1}}, {{1, 2}}});
  SnapshotReader reader(With(&SnapshotReaderParameters::misplacement_probability, 1.0), 5);
  int misplaced = 0;
  for (int i = 0; i < 200; ++i) {
    const Edits edits = reader.Read(WithWallAt({}), snapshot, {});
    REQUIRE(edits.size() == 1);
    CHECK(edits[0].cell != Cell{1, 1});
    misplaced += edits[0].cell == Cell{1, 3};
  }
  // Half of the time it would land on the robot's cell, and is put in its right place instead.
  CHECK(misplaced == Approx(100).margin(30));
}

TEST_CASE("The probability of an edit falls with distance as the parameters say", "[simulated]") {
  SnapshotReaderParameters parameters = With(&SnapshotReaderParameters::edit_probability, 0.9);
  parameters.decay_cells = 4.0;
  const BeliefGrid belief = WithWallAt({{1, 2}, {1, 7}});
  const Snapshot snapshot = LookEast({{{1, 2}, {1, 7}}, {}});
  CHECK(Rate(parameters, belief, snapshot, {1, 2}) == Approx(0.9 * std::exp(-0.25)).margin(0.025));
  CHECK(Rate(parameters, belief, snapshot, {1, 7}) == Approx(0.9 * std::exp(-1.5)).margin(0.025));
}

TEST_CASE("A far wall at the centre that continues a wall is preferred to a near lateral one",
          "[simulated]") {
  SnapshotReaderParameters parameters = With(&SnapshotReaderParameters::edit_probability, 0.6);
  parameters.lateral_factor = 0.5;
  parameters.far_centre_probability = 0.8;
  const BeliefGrid belief = DrawnMap(
      {"##########", "#        #", "#        #", "#        #", "######## #", "##########"});
  Snapshot snapshot = LookEast({{}, {{2, 2}, {3, 7}}});
  snapshot.cell = {3, 1};
  // 45 degrees off, 1.4 away; and above the wall (4,7)
  CHECK(Rate(parameters, belief, snapshot, {2, 2}) == Approx(0.3).margin(0.025));
  CHECK(Rate(parameters, belief, snapshot, {3, 7}) == Approx(0.8).margin(0.025));
}

TEST_CASE("Removals, lapses, guesses and misplacements happen at their rates", "[simulated]") {
  using P = SnapshotReaderParameters;
  Snapshot driven = LookEast({});
  driven.cell = {1, 3};
  driven.path = {{1, 1}, {1, 2}, {1, 3}};
  CHECK(Rate(With(&P::path_removal_probability, 0.9), WithWallAt({{1, 2}}), driven, {1, 2}) ==
        Approx(0.9).margin(0.02));
  CHECK(Rate(With(&P::lapse_probability, 0.2), WithWallAt({{1, 3}}), LookEast({{{1, 3}}, {}}),
             {1, 3}) == Approx(0.8).margin(0.025));
  // Only (1,3) lies next to the cells shown and can be edited.
  CHECK(Rate(With(&P::guess_probability, 0.1), WithWallAt({}), LookEast({{{1, 1}, {1, 2}}, {}}),
             {1, 3}) == Approx(0.1).margin(0.02));
  // A near wall lands one cell off along the view axis.
  SnapshotReaderParameters off = With(&P::misplacement_probability, 0.2);
  const Snapshot wall = LookEast({{{1, 1}}, {{1, 4}}});
  off.near_cells = 3.0;
  CHECK(Rate(off, WithWallAt({}), wall, {1, 3}) == Approx(0.1).margin(0.02));
  CHECK(Rate(off, WithWallAt({}), wall, {1, 4}) == Approx(0.8).margin(0.025));
  CHECK(Rate(off, WithWallAt({}), wall, {1, 5}) == Approx(0.1).margin(0.02));
  off.near_cells = 2.9;
  CHECK(Rate(off, WithWallAt({}), wall, {1, 4}) == 1.0);
}

TEST_CASE("A person stops at the edit limit, nearest first", "[simulated]") {
  SnapshotReaderParameters parameters = UnlimitedReader();
  parameters.edit_limit = 2;
  const BeliefGrid belief = WithWallAt({{1, 3}, {1, 5}, {1, 7}});
  SnapshotReader reader(parameters, 1);
  CHECK(reader.Read(belief, LookEast({{{1, 3}, {1, 5}, {1, 7}}, {}}), {}) ==
        Edits{{{1, 3}, false}, {{1, 5}, false}});
}

TEST_CASE("Each mechanism edits for reasons of its own", "[simulated]") {
  // From (3,3) to the east, in a map with walls at (3,4) and (2,5).
  BeliefGrid belief =
      DrawnMap({"#######", "#     #", "#    ##", "#   # #", "#     #", "#     #", "#######"});
  const Snapshot near{.cell = {3, 3}, .visible = {{{3, 4}}, {}}, .path = {{3, 3}}};
  const Snapshot walls{.cell = {3, 3}, .visible = {{}, {{1, 4}, {3, 5}}}, .path = {{3, 3}}};
  using Mechanism = ReadingMechanism;
  struct Row {
    Mechanism mechanism;
    double rate;
    double amount;
    const Snapshot& snapshot;
    Edits edits;
  };
  for (const auto& [mechanism, rate, amount, snapshot, edits] : std::vector<Row>{
           {Mechanism::kDistance, 0.0, 0.01, near, {{{3, 4}, false}}},
           {Mechanism::kDistance, 0.0, 0.01, walls, {}},  // beyond 1.5 cells
           {Mechanism::kLateral, 1.0, 0.0, walls, {{{2, 4}, true}, {{4, 5}, true}}},
           {Mechanism::kLateral, 0.0, 0.0, walls, {{{1, 4}, true}, {{3, 5}, true}}},
           {Mechanism::kDepth, 0.0, 0.5, walls, {{{2, 4}, true}}},
           {Mechanism::kMemory, 0.0, 0.0, near, {}},
           {Mechanism::kSketch,
            1.0,
            2.0,
            walls,
            {{{1, 4}, true}, {{2, 4}, true}, {{3, 5}, true}, {{4, 5}, true}, {{5, 5}, true}}},
           {Mechanism::kRegion, 1.0, 1.0, walls, {{{1, 4}, true}}},
           {Mechanism::kRegion, 1.0, 0.0, walls, {{{3, 5}, true}}},
           {Mechanism::kListing, 1.0, 0.0, walls, {{{1, 4}, true}}},
           {Mechanism::kOpening, 0.0, 0.0, near, {{{3, 4}, false}}},
           {Mechanism::kOpening, 0.0, 0.0, walls, {}},
       }) {
    CAPTURE(Name(mechanism), rate, amount);
    SnapshotReaderParameters parameters = UnlimitedReader();
    parameters.decay_cells = 1.5;
    parameters.mechanism = mechanism;
    parameters.rate = rate;
    parameters.amount = amount;
    SnapshotReader reader(parameters, 1);
    CHECK(reader.Read(belief, snapshot, {}) == edits);
    if (mechanism == Mechanism::kMemory) {  // at second sight
      CHECK(reader.Read(belief, snapshot, {}) == Edits{{{3, 4}, false}});
    }
  }
  SnapshotReaderParameters turned = UnlimitedReader();
  turned.mechanism = Mechanism::kHeading;
  turned.rate = 1.0;  // and by 90 degrees
  const Snapshot ahead{.cell = {3, 3}, .visible = {{}, {{3, 5}}}, .path = {{3, 3}}};
  CHECK(Rate(turned, belief, ahead, {1, 3}) == Approx(0.5).margin(0.05));
  CHECK(Rate(turned, belief, ahead, {5, 3}) == Approx(0.5).margin(0.05));
}

TEST_CASE("Equal seeds give equal edits, another seed gives others", "[simulated]") {
  const BeliefGrid belief = WithWallAt({{1, 3}, {1, 5}, {1, 8}});
  const Snapshot snapshot = LookEast({{{1, 3}, {1, 5}, {1, 8}}, {}});
  SnapshotReaderParameters parameters;
  parameters.decay_cells = 3.0;
  const auto read_many = [&](std::uint64_t seed) {
    SnapshotReader reader(parameters, seed);
    std::vector<Edits> all;
    for (int i = 0; i < 50; ++i) all.push_back(reader.Read(belief, snapshot, {}));
    return all;
  };
  CHECK(read_many(1) == read_many(1));
  CHECK(read_many(1) != read_many(2));
}

TEST_CASE("The possible cells are those that draws edit, and no others", "[simulated]") {
  SnapshotReaderParameters parameters;
  parameters.near_cells = 10.0;
  parameters.misplacement_probability = 0.5;
  parameters.guess_probability = 0.0;
  std::vector<Cell> expected = {{1, 3}, {1, 4}, {1, 5}, {1, 6}};
  SECTION("misplaced") {}
  SECTION("never misplaced") {
    parameters.misplacement_probability = 0.0;
    expected = {{1, 3}, {1, 5}};
  }
  SECTION("with guesses next to the cells shown") {
    parameters.misplacement_probability = 0.0;
    parameters.guess_probability = 0.5;
    expected = {{1, 3}, {1, 5}, {1, 6}};
  }
  const Snapshot snapshot = LookEast({{{1, 1}, {1, 2}, {1, 3}, {1, 4}}, {{0, 4}, {1, 5}}});
  const SnapshotReading reading(parameters, WithWallAt({{1, 3}}), snapshot, {});
  CHECK(reading.PossibleCells() == expected);
  Random random(2);
  std::map<Cell, int> edits;
  for (int i = 0; i < 2000; ++i) {
    for (const CellEdit& edit : reading.Draw(random)) ++edits[edit.cell];
  }
  std::vector<Cell> edited;
  for (const auto& [cell, count] : edits) edited.push_back(cell);
  CHECK(edited == expected);
}

int WrongCells(const BeliefGrid& map, const BeliefGrid& truth) {
  int wrong = 0;
  for (std::size_t i = 0; i < map.size(); ++i) wrong += map.values()[i] != truth.values()[i];
  return wrong;
}

const BeliefGrid kMaze =
    DrawnMap({"#############", "#   #   #   #", "# # # # # # #", "# #   #   # #", "# ####### # #",
              "#   #     # #", "### # ##### #", "#   # #     #", "# ### # ### #", "#     #   # #",
              "# ##### # # #", "#       #   #", "#############"});

/// kMaze with errors, seeded.
BeliefGrid WrongMaze(Random& random) {
  BeliefGrid belief = kMaze;
  for (std::size_t i = 0; i < belief.size(); ++i) {
    const Cell cell = belief.CellAt(i);
    if (!belief.OnBorder(cell) && random.Chance(0.15)) belief[cell] = 1.0F - belief[cell];
  }
  return belief;
}

/// From anywhere in kMaze, in any of 8 headings.
Snapshot PictureOfMaze(Random& random) {
  Snapshot snapshot;
  do {
    snapshot.cell = kMaze.CellAt(static_cast<std::size_t>(random.Uniform(0, 168)));
  } while (IsWall(kMaze, snapshot.cell));
  snapshot.path = {snapshot.cell};
  snapshot.heading_rad = HeadingFromIndex(static_cast<int>(random.Uniform(0, 7)), 8);
  snapshot.visible = CastView(ToOccupancy(kMaze), {snapshot.cell, snapshot.heading_rad});
  return snapshot;
}

TEST_CASE("The careful default makes a wrong map better, at about one edit a picture",
          "[simulated]") {
  constexpr int kSnapshots = 25;
  int before = 0;
  int after = 0;
  int edits = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    BeliefGrid belief = WrongMaze(random);
    const int wrong = WrongCells(belief, kMaze);
    SnapshotReader reader({}, seed);
    for (int i = 0; i < kSnapshots; ++i) {
      for (const CellEdit& edit : reader.Read(belief, PictureOfMaze(random), {})) {
        belief[edit.cell] = edit.wall ? 1.0F : 0.0F;
        ++edits;
      }
    }
    CHECK(WrongCells(belief, kMaze) < wrong);
    before += wrong;
    after += WrongCells(belief, kMaze);
  }
  CAPTURE(before, after, edits);
  CHECK(after < 0.5 * before);
  CHECK(edits > 0.3 * kSnapshots * 40);
  CHECK(edits < 1.5 * kSnapshots * 40);
}

TEST_CASE("In mazes the edits and paths are what they were before there were rasters",
          "[simulated]") {
  std::uint64_t digest = 0;
  const auto add = [&](Cell cell, bool wall) {
    digest = (digest ^ std::hash<Cell>()(cell) ^ std::uint64_t{wall}) * 0x100000001b3ULL;
  };
  for (const std::string kind : {"careful", "hasty", "wrong"}) {
    const SyntheticOperatorParameters person = ParametersOfKind(kind);
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      Random random(seed);
      const BeliefGrid belief = WrongMaze(random);
      SnapshotReader reader(person.reader, seed);
      for (int i = 0; i < 25; ++i) {
        const Snapshot snapshot = PictureOfMaze(random);
        const std::set<Cell> certain{{1, 2}, {5, 6}, {7, 9}};
        for (const CellEdit& edit : reader.Read(belief, snapshot, certain))
          add(edit.cell, edit.wall);
        const std::vector<Cell> goals{{1, 11}, {11, 1}, {7, 7}};
        const auto path = PathPlanner(person.planner).Plan(belief, certain, snapshot.cell, goals);
        for (const Cell cell : path.value()) add(cell, false);
      }
    }
  }
  CHECK(digest == 0x533924ed3b33825fULL);
}

/// Cells of 1 m, all free but for the border; what a picture from the middle towards the east shows.
struct Raster {
  Raster() : belief(60, 60, 0.0F) {
    for (std::size_t i = 0; i < belief.size(); ++i) {
      if (belief.OnBorder(belief.CellAt(i))) belief.values()[i] = 1.0F;
    }
    snapshot.grid = {60, 60, 1.0};
    snapshot.cell = {30, 5};
  }
  void Show(Cell first, Cell last, bool wall) {
    for (const Cell cell : Block(first, last)) {
      (wall ? snapshot.visible.walls : snapshot.visible.free).push_back(cell);
    }
  }
  void Believe(Cell first, Cell last, bool wall) {
    for (const Cell cell : Block(first, last)) belief[cell] = wall ? 1.0F : 0.0F;
  }
  static std::vector<Cell> Block(Cell first, Cell last) {
    std::vector<Cell> cells;
    for (int row = first.row; row <= last.row; ++row) {
      for (int column = first.column; column <= last.column; ++column) {
        cells.push_back({row, column});
      }
    }
    return cells;
  }

  BeliefGrid belief;
  Snapshot snapshot;
};

TEST_CASE("On a raster a patch is edited as a whole, and the limit counts patches", "[simulated]") {
  SnapshotReaderParameters parameters = With(&SnapshotReaderParameters::edit_probability, 0.5);
  Raster raster;
  raster.Believe({20, 20}, {29, 39}, true);  // two squares of 10 m, believed to be land
  raster.Show({20, 20}, {29, 39}, false);
  SnapshotReader reader(parameters, 1);
  std::map<std::size_t, int> counts;
  for (int i = 0; i < 2000; ++i) ++counts[reader.Read(raster.belief, raster.snapshot, {}).size()];
  REQUIRE(counts.size() == 3);  // none, one, both
  CHECK(counts[100] == Approx(1000).margin(100));
  CHECK(counts[200] == Approx(500).margin(100));
  parameters.edit_probability = 1.0;
  parameters.edit_limit = 1;
  const Edits nearest = SnapshotReader(parameters, 1).Read(raster.belief, raster.snapshot, {});
  REQUIRE(nearest.size() == 100);
  CHECK(std::ranges::all_of(nearest, [](const CellEdit& edit) { return edit.cell.column < 30; }));
}

TEST_CASE("Cells of one square that do not touch, or that the robot drove through, are apart",
          "[simulated]") {
  Raster raster;
  raster.Believe({30, 10}, {30, 19}, true);
  raster.Show({30, 10}, {30, 13}, false);
  raster.Show({30, 16}, {30, 19}, false);
  raster.snapshot.path = {{30, 16}, {30, 17}};
  SnapshotReaderParameters parameters = UnlimitedReader();
  parameters.path_removal_probability = 0.0;
  parameters.edit_limit = 1;
  const auto cells_of = [&] {
    std::vector<Cell> cells;
    for (const CellEdit& edit :
         SnapshotReader(parameters, 1).Read(raster.belief, raster.snapshot, {})) {
      cells.push_back(edit.cell);
    }
    return cells;
  };
  CHECK(cells_of() == Raster::Block({30, 10}, {30, 13}));
  parameters.edit_probability = 0.0;
  parameters.path_removal_probability = 1.0;
  CHECK(cells_of() == Raster::Block({30, 16}, {30, 17}));
}

TEST_CASE("On a raster the parameters' cells are 2 m", "[simulated]") {
  SnapshotReaderParameters parameters = With(&SnapshotReaderParameters::edit_probability, 0.9);
  parameters.decay_cells = 12.0;
  Raster raster;
  raster.belief[{30, 29}] = 1.0F;  // 24 m away
  raster.Show({30, 29}, {30, 29}, false);
  CHECK(Rate(parameters, raster.belief, raster.snapshot, {30, 29}) ==
        Approx(0.9 * std::exp(-1.0)).margin(0.025));
  // A near wall lands 2 m off as a whole.
  parameters = With(&SnapshotReaderParameters::misplacement_probability, 1.0);
  Raster wall;
  wall.Show({30, 8}, {32, 8}, true);
  const Edits edits = SnapshotReader(parameters, 1).Read(wall.belief, wall.snapshot, {});
  std::set<Cell> places;
  for (const CellEdit& edit : edits) places.insert(edit.cell);
  const int column = places.begin()->column;
  CHECK((column == 6 || column == 10));
  CHECK(places.size() == 3);
}

TEST_CASE("A guess on a raster flips what is like one cell of a square next to the picture",
          "[simulated]") {
  SnapshotReaderParameters parameters = With(&SnapshotReaderParameters::guess_probability, 1.0);
  Raster raster;
  raster.Believe({10, 0}, {14, 9}, true);
  raster.Show({20, 0}, {29, 9}, false);
  raster.snapshot.cell = {25, 5};
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Edits edits = SnapshotReader(parameters, seed).Read(raster.belief, raster.snapshot, {});
    std::set<Cell> squares;
    for (const CellEdit& edit : edits) squares.insert({edit.cell.row / 10, edit.cell.column / 10});
    REQUIRE(squares.size() == 1);
    CHECK(std::ranges::all_of(edits, &CellEdit::wall));
    // To the north of the picture, half of the square is land already.
    if (*squares.begin() == Cell{1, 0}) CHECK(edits.size() == 45);
  }
}

TEST_CASE("The careful default mends a raster whose errors are areas", "[simulated]") {
  int before = 0;
  int after = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    Raster raster;
    const BeliefGrid truth = raster.belief;
    for (int i = 0; i < 6; ++i) {
      const Cell corner{static_cast<int>(random.Uniform(2, 45)),
                        static_cast<int>(random.Uniform(8, 45))};
      raster.Believe(corner, corner + Cell{11, 11}, true);
    }
    before += WrongCells(raster.belief, truth);
    SnapshotReader reader({}, seed);
    raster.Show({1, 6}, {58, 58}, false);
    for (int i = 0; i < 10; ++i) {
      for (const CellEdit& edit : reader.Read(raster.belief, raster.snapshot, {})) {
        raster.belief[edit.cell] = edit.wall ? 1.0F : 0.0F;
      }
    }
    after += WrongCells(raster.belief, truth);
  }
  CAPTURE(before, after);
  CHECK(after < 0.5 * before);
}

}  // namespace
}  // namespace conav::operators
