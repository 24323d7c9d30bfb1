#include <catch2/catch.hpp>
#include <map>

#include "operator/simulated/picture_reader.h"
#include "unit/operator/support/drawn_map.h"

namespace conav::operators {
namespace {

/// From (1,1) to the east: a wall of the map that is none at (1,3), a missing wall at (1,5).
Snapshot TwoDifferences() {
  Snapshot picture;
  picture.cell = {1, 1};
  picture.path = {{1, 1}};
  picture.visible = {{{1, 1}, {1, 2}, {1, 3}, {1, 4}}, {{0, 4}, {1, 5}}};
  return picture;
}

const std::vector<std::string> kMap = {"##########", "#  #     #", "##########"};

PictureReaderParameters NearWallsMisplaced() {
  PictureReaderParameters parameters;
  parameters.near_cells = 10.0;
  parameters.misplacement_probability = 0.5;
  parameters.guess_probability = 0.0;
  return parameters;
}

TEST_CASE("One reading drawn often gives what a reader gives look by look",
          "[operator][simulated]") {
  PictureReaderParameters parameters;
  parameters.guess_probability = 0.3;
  parameters.edit_probability = 0.6;
  PictureReader reader(parameters, 11);
  const PictureReading reading(parameters, DrawnMap(kMap), TwoDifferences(), {});
  Random random(11);
  for (int i = 0; i < 300; ++i) {
    CHECK(reading.Draw(random) == reader.Read(DrawnMap(kMap), TwoDifferences(), {}));
  }
}

TEST_CASE("The possible cells are those that draws edit, and no others", "[operator][simulated]") {
  PictureReaderParameters parameters = NearWallsMisplaced();
  std::vector<Cell> expected = {{1, 3}, {1, 4}, {1, 5}, {1, 6}};
  SECTION("misplaced") {}
  SECTION("never misplaced") {
    parameters.misplacement_probability = 0.0;
    expected = {{1, 3}, {1, 5}};
  }
  SECTION("with guesses beside what is shown") {
    parameters.misplacement_probability = 0.0;
    parameters.guess_probability = 0.5;
    expected = {{1, 3}, {1, 5}, {1, 6}};
  }
  const PictureReading reading(parameters, DrawnMap(kMap), TwoDifferences(), {});
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

}  // namespace
}  // namespace conav::operators
