#include "sim/world/clearance.h"

#include <algorithm>
#include <cmath>

namespace conav::sim {
namespace {

/// Cells around one whose square reaches into a disc of `radius_cells` around its middle.
std::vector<Cell> Footprint(double radius_cells) {
  const int reach = static_cast<int>(std::ceil(radius_cells + 0.5));
  std::vector<Cell> offsets;
  for (int row = -reach; row <= reach; ++row) {
    for (int column = -reach; column <= reach; ++column) {
      const double down = std::max(std::abs(row) - 0.5, 0.0);
      const double right = std::max(std::abs(column) - 0.5, 0.0);
      if (down * down + right * right < radius_cells * radius_cells - 1e-9) {
        offsets.push_back({row, column});
      }
    }
  }
  return offsets;
}

bool IsShore(const OccupancyGrid& map, Cell cell) {
  for (int row = -1; row <= 1; ++row) {
    for (int column = -1; column <= 1; ++column) {
      const Cell next = cell + Cell{row, column};
      if (map.Contains(next) && map[next] == Occupancy::kFree) return true;
    }
  }
  return false;
}

}  // namespace

Grid<std::uint8_t> RoomFor(const OccupancyGrid& map, double radius_cells) {
  Grid<std::uint8_t> room(map.rows(), map.columns(), 1);
  const std::vector<Cell> footprint = Footprint(radius_cells);
  const double edge = radius_cells - 0.5 - 1e-9;  // from a cell's middle to the map's edge
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Cell cell = map.CellAt(i);
    const int to_edge = std::min(std::min(cell.row, map.rows() - 1 - cell.row),
                                 std::min(cell.column, map.columns() - 1 - cell.column));
    if (to_edge < edge) room.values()[i] = 0;
    if (map.values()[i] == Occupancy::kFree) continue;
    room.values()[i] = 0;
    if (!IsShore(map, cell)) continue;
    for (const Cell offset : footprint) {
      if (room.Contains(cell + offset)) room[cell + offset] = 0;
    }
  }
  return room;
}

Grid<int> StepsFrom(const Grid<std::uint8_t>& room, Cell from) {
  Grid<int> steps(room.rows(), room.columns(), -1);
  if (room[from] == 0) return steps;
  std::vector<Cell> queue{from};
  steps[from] = 0;
  for (std::size_t next = 0; next < queue.size(); ++next) {
    const Cell cell = queue[next];
    for (const Cell offset : kNeighbourOffsets) {
      const Cell neighbour = cell + offset;
      if (!room.Contains(neighbour) || room[neighbour] == 0 || steps[neighbour] >= 0) continue;
      steps[neighbour] = steps[cell] + 1;
      queue.push_back(neighbour);
    }
  }
  return steps;
}

std::vector<Cell> WayBack(const Grid<int>& steps, Cell from) {
  std::vector<Cell> way;
  if (steps[from] < 0) return way;
  for (Cell cell = from;;) {
    way.push_back(cell);
    if (steps[cell] == 0) return way;
    const auto next = std::ranges::find_if(kNeighbourOffsets, [&](Cell offset) {
      return steps.Contains(cell + offset) && steps[cell + offset] == steps[cell] - 1;
    });
    cell = cell + *next;
  }
}

std::vector<Cell> LargestArea(const Grid<std::uint8_t>& room) {
  std::vector<Cell> largest;
  Grid<std::uint8_t> left = room;
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (left.values()[i] == 0) continue;
    std::vector<Cell> area{left.CellAt(i)};
    left.values()[i] = 0;
    for (std::size_t next = 0; next < area.size(); ++next) {
      for (const Cell offset : kNeighbourOffsets) {
        const Cell neighbour = area[next] + offset;
        if (!left.Contains(neighbour) || left[neighbour] == 0) continue;
        left[neighbour] = 0;
        area.push_back(neighbour);
      }
    }
    if (area.size() > largest.size()) largest = std::move(area);
  }
  std::ranges::sort(largest);
  return largest;
}

namespace {

/// The largest radius whose room `holds`.
template <class Holds>
double WidestThat(const OccupancyGrid& map, Holds&& holds) {
  constexpr int kParts = 4;  // of a cell
  int fits = -1;
  int too_wide = 64 * kParts + 1;
  while (too_wide - fits > 1) {
    const int middle = (fits + too_wide) / 2;
    (holds(RoomFor(map, static_cast<double>(middle) / kParts)) ? fits : too_wide) = middle;
  }
  return static_cast<double>(fits) / kParts;
}

}  // namespace

double WidestRadius(const OccupancyGrid& map, Cell from, Cell to) {
  return WidestThat(map,
                    [&](const Grid<std::uint8_t>& room) { return StepsFrom(room, from)[to] >= 0; });
}

double WidestRadius(const OccupancyGrid& map) {
  const std::size_t most = LargestArea(RoomFor(map, 0.0)).size();
  return WidestThat(map, [&](const Grid<std::uint8_t>& room) {
    return most > 0 && 2 * LargestArea(room).size() >= most;
  });
}

}  // namespace conav::sim
