#include "sim/world/maze_simplification.h"

#include "sim/world/maze_rooms.h"
#include "sim/world/random_maze.h"

namespace conav::sim {
namespace {

/// Up, down, left, right: the last free neighbour in this order is where the filling goes on.
constexpr std::array<Cell, 4> kFillDirections{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};

void FillFrom(Cell cell, Grid<char>& entities) {
  while (entities[cell] == kMazeFree) {
    int walls = 0;
    int neighbours = 0;
    bool goes_on = false;
    Cell next;
    for (const Cell direction : kFillDirections) {
      const Cell neighbour = cell + direction;
      if (!entities.Contains(neighbour)) continue;
      ++neighbours;
      if (entities[neighbour] == kMazeWall) ++walls;
      if (entities[neighbour] == kMazeFree) {
        goes_on = true;
        next = neighbour;
      }
    }
    if (walls + 1 < neighbours) return;
    entities[cell] = kMazeWall;
    if (!goes_on) return;
    cell = next;
  }
}

/// A bend seen from corner `p`: At(a, b) = p + a u + b v.
struct BendFrame {
  Cell p;
  Cell u;
  Cell v;
  int length;

  Cell At(int a, int b) const {
    return {p.row + a * u.row + b * v.row, p.column + a * u.column + b * v.column};
  }
};

bool IsBend(const BendFrame& frame, const Grid<char>& entities) {
  const auto is = [&](int a, int b, char wanted) {
    const Cell cell = frame.At(a, b);
    return entities.Contains(cell) && entities[cell] == wanted;
  };
  const int length = frame.length;
  for (int a = 0; a < length; ++a) {
    if (!is(a, 0, kMazeWall) || !is(a, -1, kMazeWall)) return false;
  }
  for (int a = -1; a <= length; ++a) {
    if (!is(a, 1, kMazeFree) || !is(a, 2, kMazeWall)) return false;
  }
  return is(-2, 1, kMazeWall) && is(length + 1, 1, kMazeWall) && is(-1, 0, kMazeFree) &&
         is(length, 0, kMazeFree);
}

void MoveDown(const BendFrame& frame, Grid<char>& entities) {
  for (int a = 0; a < frame.length; ++a) entities[frame.At(a, 0)] = entities[frame.At(a, 1)];
  for (int a = -1; a <= frame.length; ++a) entities[frame.At(a, 1)] = kMazeWall;
}

/// Straightens one bend at wall cell `p`; the cell to look at next, if there was one.
bool StraightenOnce(Cell& p, int length, Grid<char>& entities) {
  if (!entities.Contains(p) || entities[p] != kMazeWall) return false;
  for (const Cell v : kMazeDirections) {
    const BendFrame frame{p, {v.column, -v.row}, v, length};
    if (!IsBend(frame, entities)) continue;
    MoveDown(frame, entities);
    p = frame.At(0, -1);
    return true;
  }
  return false;
}

/// Straightens, as often as it goes, the first bend of this length; false when there is none.
bool StraightenFirst(int length, Grid<char>& entities) {
  for (std::size_t i = 0; i < entities.size(); ++i) {
    Cell p = entities.CellAt(i);
    if (!StraightenOnce(p, length, entities)) continue;
    while (StraightenOnce(p, length, entities)) {
    }
    return true;
  }
  return false;
}

}  // namespace

void FillDeadEnds(Grid<char>& entities) {
  for (std::size_t i = 0; i < entities.size(); ++i) FillFrom(entities.CellAt(i), entities);
}

void StraightenBends(Grid<char>& entities) {
  int length = 1;
  while (length + 3 < entities.columns()) {
    const bool removed = StraightenFirst(length, entities);
    length = removed && length != 1 ? 1 : length + 1;
  }
}

}  // namespace conav::sim
