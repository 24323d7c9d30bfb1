#pragma once

#include <vector>

#include "common/grid/grid.h"

namespace conav::sim {

/// A block of cells of one class.
struct CellRectangle {
  Cell north_west;
  int rows = 1;
  int columns = 1;
  char cell_class = 0;
};

/// A straight run of wall faces: `length` wall cells from `first` (to the east or to the south),
/// each with a free cell on the side `normal` (one of kNeighbourOffsets).
struct FaceRun {
  Cell first;
  Cell normal;
  int length = 1;
  char cell_class = 0;
};

/// Class of a cell that is not to be covered.
inline constexpr char kNoClass = 0;

/// Odd: MuJoCo centres a texture on its plane, and only odd sides then show whole tiles.
enum class Sides { kAny, kOdd };

/// Covers all cells whose class is not kNoClass with rectangles of one class each, without overlap:
/// scan row-major, extend right, then down.
std::vector<CellRectangle> CoverWithRectangles(const Grid<char>& classes, Sides sides);

/// The faces between wall cells (class not kNoClass) and free cells inside the grid; lengths odd.
std::vector<FaceRun> ExposedFaces(const Grid<char>& wall_classes);

}  // namespace conav::sim
