#include "sim/physics/covering.h"

namespace conav::sim {
namespace {

int MakeOdd(int length) { return length % 2 == 0 ? length - 1 : length; }

/// Cells from `start` along `step` for which `matches` holds.
template <class Matches>
int RunLength(Cell start, Cell step, Matches&& matches) {
  int length = 0;
  for (Cell cell = start; matches(cell); cell = cell + step) ++length;
  return length;
}

}  // namespace

std::vector<CellRectangle> CoverWithRectangles(const Grid<char>& classes, Sides sides) {
  std::vector<CellRectangle> rectangles;
  Grid<char> left = classes;
  for (std::size_t i = 0; i < left.size(); ++i) {
    const char cell_class = left.values()[i];
    if (cell_class == kNoClass) continue;
    const Cell corner = left.CellAt(i);
    const auto matches = [&](Cell cell) { return left.Contains(cell) && left[cell] == cell_class; };
    int columns = RunLength(corner, {0, 1}, matches);
    if (sides == Sides::kOdd) columns = MakeOdd(columns);
    int rows = RunLength(corner, {1, 0}, [&](Cell row) {
      return RunLength(row, {0, 1}, matches) >= columns;
    });
    if (sides == Sides::kOdd) rows = MakeOdd(rows);
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < columns; ++c) left[corner + Cell{r, c}] = kNoClass;
    }
    rectangles.push_back({corner, rows, columns, cell_class});
  }
  return rectangles;
}

std::vector<FaceRun> ExposedFaces(const Grid<char>& wall_classes) {
  std::vector<FaceRun> runs;
  for (const Cell normal : kNeighbourOffsets) {
    Grid<char> exposed(wall_classes.rows(), wall_classes.columns(), kNoClass);
    for (std::size_t i = 0; i < exposed.size(); ++i) {
      const Cell cell = exposed.CellAt(i);
      const Cell front = cell + normal;
      if (exposed.Contains(front) && wall_classes[front] == kNoClass) {
        exposed[cell] = wall_classes[cell];
      }
    }
    const Cell along = normal.row != 0 ? Cell{0, 1} : Cell{1, 0};
    for (std::size_t i = 0; i < exposed.size(); ++i) {
      const char cell_class = exposed.values()[i];
      if (cell_class == kNoClass) continue;
      const Cell first = exposed.CellAt(i);
      const int length = MakeOdd(RunLength(first, along, [&](Cell cell) {
        return exposed.Contains(cell) && exposed[cell] == cell_class;
      }));
      Cell cell = first;
      for (int n = 0; n < length; ++n, cell = cell + along) exposed[cell] = kNoClass;
      runs.push_back({first, normal, length, cell_class});
    }
  }
  return runs;
}

}  // namespace conav::sim
