#include <catch2/catch.hpp>

#include "operator/simulated/steering.h"

using namespace conav;
using namespace conav::operators;

namespace {

PictureReaderParameters Perfect() {
  PictureReaderParameters reader;
  reader.edit_probability = 1.0;
  reader.decay_cells = 1e6;
  reader.misplacement_probability = 0.0;
  reader.lapse_probability = 0.0;
  return reader;
}

/// From (2,1) to the east: (2,2) is free, (2,3) a wall.
Snapshot Eastward() {
  Snapshot picture;
  picture.cell = {2, 1};
  picture.visible = {{{2, 1}, {2, 2}}, {{2, 3}}};
  return picture;
}

}  // namespace

TEST_CASE("a wall is believed when it was noticed twice, a free cell at once",
          "[operator][teleoperator]") {
  StreamMemory memory(5, 5);
  Random random(1);
  memory.Look(Perfect(), Eastward(), random);
  CHECK(memory.IsFree({2, 2}));
  CHECK_FALSE(memory.IsWall({2, 3}));
  memory.Look(Perfect(), Eastward(), random);
  CHECK(memory.IsWall({2, 3}));
  CHECK(memory.Walls() == std::set<Cell>{{2, 3}});
}

TEST_CASE("what was seen is put over the map, and the map's errors are named",
          "[operator][teleoperator]") {
  StreamMemory memory(5, 5);
  Random random(1);
  for (int i = 0; i < 2; ++i) memory.Look(Perfect(), Eastward(), random);
  BeliefGrid map(5, 5, 0.0F);
  map[{2, 2}] = 1.0F;
  CHECK(memory.Over(map)[{2, 2}] == 0.0F);
  CHECK(memory.Over(map)[{2, 3}] == 1.0F);
  CHECK(memory.Errors(map, 6) == std::vector<CellEdit>{{{2, 2}, false}, {{2, 3}, true}});
  CHECK(memory.Errors(map, 1).size() == 1);
}

TEST_CASE("a mistaken wall is put right by the next looks, and what was driven through is free",
          "[operator][teleoperator]") {
  StreamMemory memory(5, 5);
  Random random(1);
  memory.Bump({2, 2});
  CHECK(memory.IsWall({2, 2}));
  for (int i = 0; i < 2; ++i) memory.Look(Perfect(), Eastward(), random);
  CHECK(memory.IsFree({2, 2}));
  memory.Bump({3, 1});
  Snapshot picture = Eastward();
  picture.path = {{3, 1}, {2, 1}};
  memory.Look(Perfect(), picture, random);
  CHECK(memory.IsFree({3, 1}));
}

TEST_CASE("a picture that is not looked at teaches nothing", "[operator][teleoperator]") {
  StreamMemory memory(5, 5);
  Random random(1);
  PictureReaderParameters absent = Perfect();
  absent.lapse_probability = 1.0;
  memory.Look(absent, Eastward(), random);
  CHECK_FALSE(memory.IsFree({2, 2}));
}

TEST_CASE("a near wall may be taken for one a cell off", "[operator][teleoperator]") {
  PictureReaderParameters reader = Perfect();
  reader.misplacement_probability = 1.0;
  StreamMemory memory(5, 5);
  Random random(3);
  for (int i = 0; i < 20; ++i) memory.Look(reader, Eastward(), random);
  CHECK_FALSE(memory.IsWall({2, 3}));
  CHECK(memory.IsWall({2, 4}));
}

TEST_CASE("cells outside of the map are ignored", "[operator][teleoperator]") {
  StreamMemory memory(2, 2);
  Random random(1);
  memory.Look(Perfect(), Eastward(), random);
  memory.Bump({7, 7});
  CHECK(memory.Walls().empty());
}

TEST_CASE("walls can be forgotten, to look again", "[operator][teleoperator]") {
  StreamMemory memory(5, 5);
  memory.Bump({2, 2});
  memory.ForgetWalls();
  CHECK(memory.Walls().empty());
}
