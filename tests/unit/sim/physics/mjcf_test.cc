#include "sim/physics/mjcf.h"

#include <catch2/catch.hpp>
#include <numeric>

namespace conav::sim {
namespace {

Grid<char> Classes(const std::vector<std::string>& rows) {
  Grid<char> classes(static_cast<int>(rows.size()), static_cast<int>(rows.front().size()));
  for (std::size_t i = 0; i < classes.size(); ++i) {
    const Cell cell = classes.CellAt(i);
    const char symbol =
        rows[static_cast<std::size_t>(cell.row)][static_cast<std::size_t>(cell.column)];
    classes.values()[i] = symbol == ' ' ? kNoClass : symbol;
  }
  return classes;
}

TEST_CASE("rectangles cover every classed cell once and nothing else", "[physics]") {
  const Sides sides = GENERATE(Sides::kAny, Sides::kOdd);
  const Grid<char> classes = Classes({"aaaabb", "aaaab ", " aa   ", "cccccc"});
  Grid<char> covered(classes.rows(), classes.columns(), kNoClass);
  for (const CellRectangle& block : CoverWithRectangles(classes, sides)) {
    for (int r = 0; r < block.rows; ++r) {
      for (int c = 0; c < block.columns; ++c) {
        const Cell cell = block.north_west + Cell{r, c};
        CHECK(covered[cell] == kNoClass);
        covered[cell] = block.cell_class;
      }
    }
    if (sides == Sides::kOdd) CHECK(block.rows % 2 * (block.columns % 2) == 1);
  }
  CHECK(covered == classes);
}

TEST_CASE("a block of one class is one rectangle, its outer faces are not shown", "[physics]") {
  const auto blocks = CoverWithRectangles(Classes({"aaaa", "aaaa"}), Sides::kAny);
  REQUIRE(blocks.size() == 1);
  CHECK(blocks[0].rows == 2);
  CHECK(blocks[0].columns == 4);
  CHECK(ExposedFaces(Classes({"   ", " a ", "   "})).size() == 4);
  CHECK(ExposedFaces(Classes({"a  ", "   "})).size() == 2);
  CHECK(ExposedFaces(Classes({"aaa", "aaa"})).empty());
}

TEST_CASE("a row of faces is merged into odd runs of one class", "[physics]") {
  const auto runs = ExposedFaces(Classes({"aaaab", "     "}));
  const int length = std::accumulate(runs.begin(), runs.end(), 0,
                                     [](int sum, const FaceRun& run) { return sum + run.length; });
  CHECK(runs.size() == 3);  // aaa, a, b
  CHECK(length == 5);
  for (const FaceRun& run : runs) CHECK(run.normal == Cell{1, 0});
}

}  // namespace
}  // namespace conav::sim
