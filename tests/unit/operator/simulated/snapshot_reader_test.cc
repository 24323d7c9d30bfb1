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

TEST_CASE("The careful default makes a wrong map better, at about one edit a picture",
          "[simulated]") {
  const BeliefGrid truth =
      DrawnMap({"#############", "#   #   #   #", "# # # # # # #", "# #   #   # #", "# ####### # #",
                "#   #     # #", "### # ##### #", "#   # #     #", "# ### # ### #", "#     #   # #",
                "# ##### # # #", "#       #   #", "#############"});
  constexpr int kSnapshots = 25;
  int before = 0;
  int after = 0;
  int edits = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    BeliefGrid belief = truth;
    for (std::size_t i = 0; i < belief.size(); ++i) {
      const Cell cell = belief.CellAt(i);
      if (!belief.OnBorder(cell) && random.Chance(0.15)) belief[cell] = 1.0F - belief[cell];
    }
    const int wrong = WrongCells(belief, truth);
    SnapshotReader reader({}, seed);
    for (int i = 0; i < kSnapshots; ++i) {
      Snapshot snapshot;
      do {
        snapshot.cell = truth.CellAt(static_cast<std::size_t>(random.Uniform(0, 168)));
      } while (IsWall(truth, snapshot.cell));
      snapshot.path = {snapshot.cell};
      snapshot.heading_rad = HeadingFromIndex(static_cast<int>(random.Uniform(0, 7)), 8);
      snapshot.visible = CastView(ToOccupancy(truth), {snapshot.cell, snapshot.heading_rad});
      for (const CellEdit& edit : reader.Read(belief, snapshot, {})) {
        belief[edit.cell] = edit.wall ? 1.0F : 0.0F;
        ++edits;
      }
    }
    CHECK(WrongCells(belief, truth) < wrong);
    before += wrong;
    after += WrongCells(belief, truth);
  }
  CAPTURE(before, after, edits);
  CHECK(after < 0.5 * before);
  CHECK(edits > 0.3 * kSnapshots * 40);
  CHECK(edits < 1.5 * kSnapshots * 40);
}

}  // namespace
}  // namespace conav::operators
