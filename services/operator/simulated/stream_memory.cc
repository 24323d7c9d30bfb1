#include "operator/simulated/stream_memory.h"

#include <algorithm>
#include <cmath>

#include "operator/simulated/path_planner.h"

namespace conav::operators {
namespace {

/// The neighbouring cell that `heading_rad` points to, as an offset; diagonals included.
Cell AxisOffset(double heading_rad) {
  return {-static_cast<int>(std::lround(std::sin(heading_rad))),
          static_cast<int>(std::lround(std::cos(heading_rad)))};
}

}  // namespace

void StreamMemory::Look(const PictureReaderParameters& parameters, const Picture& picture,
                        Random& random) {
  if (random.Chance(parameters.lapse_probability)) return;
  const auto distance = [&](Cell cell) {
    return std::hypot(cell.row - picture.cell.row, cell.column - picture.cell.column);
  };
  const auto noticed = [&](Cell cell) {
    return random.Chance(parameters.edit_probability *
                         std::exp(-distance(cell) / parameters.decay_cells));
  };
  for (const Cell cell : picture.visible.free) {
    if (noticed(cell)) NoteFree(cell);
  }
  const Cell axis = AxisOffset(picture.heading_rad);
  for (const Cell cell : picture.visible.walls) {
    if (!noticed(cell)) continue;
    const bool misplaced = distance(cell) <= parameters.near_cells &&
                           random.Chance(parameters.misplacement_probability);
    if (!misplaced) {
      NoteWall(cell);
    } else {
      NoteWall(random.Chance(0.5) ? cell + axis : cell - axis);
    }
  }
  const auto driven = [&](Cell cell) {
    if (cells_.Contains(cell)) cells_[cell] = {0, true};
  };
  for (const Cell cell : picture.path) driven(cell);
  driven(picture.cell);
}

void StreamMemory::NoteFree(Cell cell) {
  if (!cells_.Contains(cell)) return;
  Noticed& noticed = cells_[cell];
  noticed.free = true;
  noticed.wall = std::max(noticed.wall - 2, 0);
}

void StreamMemory::NoteWall(Cell cell) {
  if (!cells_.Contains(cell)) return;
  Noticed& noticed = cells_[cell];
  noticed.wall = std::min(noticed.wall + 1, kSure);
}

void StreamMemory::Bump(Cell wall) {
  if (cells_.Contains(wall)) cells_[wall] = {kSure, false};
}

void StreamMemory::ForgetWalls() {
  for (std::size_t i = 0; i < cells_.size(); ++i) cells_[cells_.CellAt(i)].wall = 0;
}

BeliefGrid StreamMemory::Over(const BeliefGrid& belief) const {
  BeliefGrid map = belief;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Cell cell = map.CellAt(i);
    if (IsWall(cell)) map[cell] = 1.0F;
    if (IsFree(cell)) map[cell] = 0.0F;
  }
  return map;
}

std::set<Cell> StreamMemory::Walls() const {
  std::set<Cell> walls;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (IsWall(cells_.CellAt(i))) walls.insert(cells_.CellAt(i));
  }
  return walls;
}

std::vector<CellEdit> StreamMemory::Errors(const BeliefGrid& belief, int limit) const {
  std::vector<CellEdit> edits;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const Cell cell = cells_.CellAt(i);
    if (belief.OnBorder(cell) || static_cast<int>(edits.size()) >= limit) continue;
    const bool shown_as_wall = operators::IsWall(belief, cell);
    if (IsWall(cell) && !shown_as_wall) edits.push_back({cell, true});
    if (IsFree(cell) && shown_as_wall) edits.push_back({cell, false});
  }
  return edits;
}

}  // namespace conav::operators
