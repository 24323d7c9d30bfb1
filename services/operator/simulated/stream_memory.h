#pragma once

#include <set>
#include <vector>

#include "common/grid/grid.h"
#include "common/protocol/robot.h"
#include "common/protocol/supervision.h"
#include "common/runtime/random.h"
#include "operator/simulated/picture_reading.h"

namespace conav::operators {

/// What a synthetic teleoperator has made out in the pictures of a stream, beside the map: cells
/// noticed free, and walls, in which a wall must be noticed twice to be believed. A picture may not
/// be looked at, a cell overlooked (the farther the more), a near wall taken for one a cell off, as
/// the reader's parameters say; the next pictures put that right. What was driven through is free.
class StreamMemory {
 public:
  StreamMemory(int rows, int columns) : cells_(rows, columns) {}

  /// `picture` shows cells inside of the map only; others are ignored.
  void Look(const PictureReaderParameters& parameters, const Picture& picture, Random& random);
  /// The robot bumped into it.
  void Bump(Cell wall);
  void ForgetWalls();

  bool IsWall(Cell cell) const { return cells_[cell].wall >= kBelieved; }
  bool IsFree(Cell cell) const { return cells_[cell].free && !IsWall(cell); }

  /// `belief` with what was seen instead, as 0 and 1.
  BeliefGrid Over(const BeliefGrid& belief) const;
  std::set<Cell> Walls() const;
  /// Cells inside of the border that `belief` shows otherwise than they were seen, row-major, at
  /// most `limit`.
  std::vector<CellEdit> Errors(const BeliefGrid& belief, int limit) const;

 private:
  static constexpr int kBelieved = 2;  // times
  static constexpr int kSure = 4;
  struct Noticed {
    int wall = 0;  // how often, of late
    bool free = false;
  };
  void NoteFree(Cell cell);
  void NoteWall(Cell cell);

  Grid<Noticed> cells_;
};

}  // namespace conav::operators
