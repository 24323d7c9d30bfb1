#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/grid/grid.h"
#include "common/grid/visibility.h"
#include "common/runtime/random.h"

namespace conav::planner {

/// A map whose cells are occupied where `is_land(cell)` says so, and free elsewhere.
template <class IsLand>
OccupancyGrid RasterOf(int rows, int columns, IsLand&& is_land) {
  OccupancyGrid map(rows, columns, Occupancy::kFree);
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (is_land(map.CellAt(i))) map.values()[i] = Occupancy::kOccupied;
  }
  return map;
}

/// Smooth land and water: noise interpolated between the corners of squares with sides `scale`.
inline OccupancyGrid Waterway(int side, int scale, Random& random) {
  Grid<double> height(side / scale + 2, side / scale + 2);
  for (double& value : height.values()) value = random.Unit();
  const auto smooth = [](double t) { return t * t * (3.0 - 2.0 * t); };
  return RasterOf(side, side, [&](Cell cell) {
    const Cell corner{cell.row / scale, cell.column / scale};
    const double down = smooth(static_cast<double>(cell.row % scale) / scale);
    const double right = smooth(static_cast<double>(cell.column % scale) / scale);
    const auto between = [&](Cell left) {
      return height[left] + right * (height[left + Cell{0, 1}] - height[left]);
    };
    const double upper = between(corner);
    return upper + down * (between(corner + Cell{1, 0}) - upper) > 0.55;
  });
}

/// Each cell land by itself.
inline OccupancyGrid Speckles(int side, double share, Random& random) {
  return RasterOf(side, side, [&](Cell) { return random.Chance(share); });
}

/// A spanning-tree maze with corridors `width` cells wide and walls of one.
inline OccupancyGrid ScaledMaze(int rooms, int width, Random& random) {
  const int pitch = width + 1;
  OccupancyGrid map = RasterOf(rooms * pitch + 1, rooms * pitch + 1, [&](Cell cell) {
    return cell.row % pitch == 0 || cell.column % pitch == 0;
  });
  Grid<std::uint8_t> entered(rooms, rooms, 0);
  std::vector<Cell> branch{{0, 0}};
  entered[branch.back()] = 1;
  while (!branch.empty()) {
    std::vector<Cell> ways(kNeighbourOffsets.begin(), kNeighbourOffsets.end());
    random.Shuffle(ways);
    const Cell here = branch.back();
    const auto way = std::ranges::find_if(ways, [&](Cell step) {
      return entered.Contains(here + step) && entered[here + step] == 0;
    });
    if (way == ways.end()) {
      branch.pop_back();
      continue;
    }
    branch.push_back(here + *way);
    entered[branch.back()] = 1;
    for (int i = 1; i <= width; ++i) {  // through the wall between the two
      map[way->row != 0 ? Cell{(here.row + (way->row > 0)) * pitch, here.column * pitch + i}
                        : Cell{here.row * pitch + i, (here.column + (way->column > 0)) * pitch}] =
          Occupancy::kFree;
    }
  }
  return map;
}

/// One corridor `width` cells wide that winds to the middle.
inline OccupancyGrid Spiral(int side, int width) {
  OccupancyGrid map(side, side, Occupancy::kOccupied);
  int top = 1, left = 1, bottom = side - 2, right = side - 2;
  const auto carve = [&](int first_row, int first_column, int last_row, int last_column) {
    for (int row = std::max(first_row, 1); row <= std::min(last_row, side - 2); ++row) {
      for (int column = std::max(first_column, 1); column <= std::min(last_column, side - 2);
           ++column) {
        map[{row, column}] = Occupancy::kFree;
      }
    }
  };
  const int step = width + 1;
  while (right - left > 2 * step && bottom - top > 2 * step) {
    carve(top, left, top + width - 1, right);
    carve(top, right - width + 1, bottom, right);
    carve(bottom - width + 1, left, bottom, right);
    carve(top + step, left, bottom, left + width - 1);
    carve(top + step, left, top + step + width - 1, left + step);  // on to the next turn
    top += step, left += step, bottom -= step, right -= step;
  }
  return map;
}

/// A staircase from corner to corner, `width` cells wide in each row.
inline OccupancyGrid DiagonalCorridor(int side, int width) {
  return RasterOf(side, side, [&](Cell cell) {
    const int offset = cell.column - cell.row;
    return offset < 0 || offset > width;
  });
}

/// What a robot knows that has a sensor of `range_cells` and visits one free cell after another.
class Exploration {
 public:
  Exploration(OccupancyGrid truth, double range_cells, std::uint64_t seed)
      : truth_(std::move(truth)),
        known_(truth_.rows(), truth_.columns(), Occupancy::kUnknown),
        range_cells_(range_cells),
        random_(seed) {
    do {
      here_ = truth_.CellAt(
          static_cast<std::size_t>(random_.Uniform(0, static_cast<int>(truth_.size()) - 1)));
    } while (truth_[here_] != Occupancy::kFree);
    Look();
  }

  /// Goes up to `steps` cells towards somewhere, and looks.
  const OccupancyGrid& Go(int steps) {
    for (int i = 0; i < steps; ++i) {
      const Cell next = here_ + kNeighbourOffsets[static_cast<std::size_t>(way_)];
      if (truth_.Contains(next) && truth_[next] == Occupancy::kFree && !random_.Chance(0.05)) {
        here_ = next;
      } else {
        way_ = static_cast<int>(random_.Uniform(0, 3));
      }
    }
    Look();
    return known_;
  }

  const OccupancyGrid& known() const { return known_; }

 private:
  void Look() {
    const VisibleCells seen = CastRange(truth_, here_, range_cells_);
    for (const Cell cell : seen.free) known_[cell] = Occupancy::kFree;
    for (const Cell cell : seen.walls) known_[cell] = Occupancy::kOccupied;
  }

  OccupancyGrid truth_;
  OccupancyGrid known_;
  double range_cells_;
  Random random_;
  Cell here_;
  int way_ = 0;
};

}  // namespace conav::planner
