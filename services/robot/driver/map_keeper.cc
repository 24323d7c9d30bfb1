#include "robot/driver/map_keeper.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace conav::robot {
namespace {

constexpr int kLeastSamples = 3;  // along a cell's side
constexpr int kMostSamples = 24;

}  // namespace

MapKeeper::MapKeeper(const GridGeometry& grid, const Options& options)
    : grid_(grid), options_(options), known_(grid.rows, grid.columns, Occupancy::kUnknown) {}

Position MapKeeper::ToMap(Position place) const {
  return {origin_from_plan_.position.x_m + cosine_ * place.x_m - sine_ * place.y_m,
          origin_from_plan_.position.y_m + sine_ * place.x_m + cosine_ * place.y_m};
}

std::optional<std::size_t> MapKeeper::IndexOf(Position place) const {
  const Position local = ToMap(place);
  const double column = std::floor(local.x_m / map_.resolution_m);
  const double row = std::floor(local.y_m / map_.resolution_m);
  if (!(column >= 0.0 && column < map_.columns && row >= 0.0 && row < map_.rows)) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(map_.columns) +
         static_cast<std::size_t>(column);
}

MapKeeper::Fine MapKeeper::FineAt(Position place) const {
  const auto index = IndexOf(place);
  if (!index) return Fine::kUnknown;
  const int value = map_.data[*index];
  if (value >= options_.occupied_from) return Fine::kWall;
  return value >= 0 && value <= options_.free_up_to ? Fine::kFree : Fine::kUnknown;
}

bool MapKeeper::IsThickAt(Position place) const {
  const auto index = IndexOf(place);
  return index && thick_[*index] != 0;
}

void MapKeeper::Thicken() {
  const int reach = static_cast<int>(std::floor(options_.radius_m / map_.resolution_m));
  std::vector<Cell> disc;
  for (int row = -reach; row <= reach; ++row) {
    for (int column = -reach; column <= reach; ++column) {
      if (std::hypot(row, column) * map_.resolution_m < options_.radius_m) {
        disc.push_back({row, column});
      }
    }
  }
  thick_.assign(map_.data.size(), 0);
  for (int row = 0; row < map_.rows; ++row) {
    for (int column = 0; column < map_.columns; ++column) {
      const auto at = [&](int r, int c) {
        return static_cast<std::size_t>(r) * static_cast<std::size_t>(map_.columns) +
               static_cast<std::size_t>(c);
      };
      if (map_.data[at(row, column)] < options_.occupied_from) continue;
      for (const Cell offset : disc) {
        const int r = row + offset.row;
        const int c = column + offset.column;
        if (r >= 0 && r < map_.rows && c >= 0 && c < map_.columns) thick_[at(r, c)] = 1;
      }
    }
  }
}

MapKeeper::Share MapKeeper::ShareOf(Cell cell) const {
  const int side = std::clamp(static_cast<int>(std::ceil(grid_.cell_size_m / map_.resolution_m)),
                              kLeastSamples, kMostSamples);
  const Position middle = grid_.CellToPosition(cell);
  Share share;
  share.all = side * side;
  const Position local = ToMap(middle);
  const double reach_m = grid_.cell_size_m;
  if (local.x_m < -reach_m || local.x_m > map_.columns * map_.resolution_m + reach_m ||
      local.y_m < -reach_m || local.y_m > map_.rows * map_.resolution_m + reach_m) {
    return share;  // far off the robot's map
  }
  for (int i = 0; i < side * side; ++i) {
    const double east = ((i % side + 0.5) / side - 0.5) * grid_.cell_size_m;
    const double north = ((i / side + 0.5) / side - 0.5) * grid_.cell_size_m;
    const Fine fine = FineAt({middle.x_m + east, middle.y_m + north});
    if (fine == Fine::kFree) ++share.free;
    if (fine == Fine::kWall) ++share.walls;
  }
  return share;
}

bool MapKeeper::IsCrossed(Position from, Position to) const {
  const double length_m = Distance(from, to);
  const int steps = 1 + static_cast<int>(std::ceil(2.0 * length_m / map_.resolution_m));
  for (int i = 0; i <= steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    if (FineAt({from.x_m + share * (to.x_m - from.x_m), from.y_m + share * (to.y_m - from.y_m)}) ==
        Fine::kWall) {
      return true;
    }
  }
  return false;
}

void MapKeeper::PartNeighbours(OccupancyGrid& seen, const Grid<Share>& shares) const {
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Cell cell = seen.CellAt(i);
    for (const Cell offset : {Cell{0, 1}, Cell{1, 0}}) {
      const Cell next = cell + offset;
      if (!seen.Contains(next) || seen[cell] == Occupancy::kOccupied ||
          seen[next] == Occupancy::kOccupied) {
        continue;
      }
      if (seen[cell] != Occupancy::kFree && seen[next] != Occupancy::kFree) continue;
      if (!IsCrossed(grid_.CellToPosition(cell), grid_.CellToPosition(next))) continue;
      seen[shares[cell].free < shares[next].free ? cell : next] = Occupancy::kOccupied;
    }
  }
}

void MapKeeper::Receive(RobotMap map) {
  map_ = std::move(map);
  origin_from_plan_ = Inverse(map_.plan_from_origin);
  cosine_ = std::cos(origin_from_plan_.heading_rad);
  sine_ = std::sin(origin_from_plan_.heading_rad);
  Thicken();
  OccupancyGrid seen(grid_.rows, grid_.columns, Occupancy::kUnknown);
  Grid<Share> shares(grid_.rows, grid_.columns);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Cell cell = seen.CellAt(i);
    const Share share = ShareOf(cell);
    shares[cell] = share;
    if (IsThickAt(grid_.CellToPosition(cell)) ||
        (share.walls > 0 && 3 * share.walls >= share.walls + share.free)) {
      seen[cell] = Occupancy::kOccupied;
    } else if (2 * share.free >= share.all) {
      seen[cell] = Occupancy::kFree;
    }
  }
  PartNeighbours(seen, shares);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen.values()[i] != Occupancy::kUnknown) known_.values()[i] = seen.values()[i];
  }
}

OccupancyGrid MapKeeper::Known(Clock::TimePoint now) const {
  OccupancyGrid known = known_;
  for (const auto& [cell, until] : blocked_) {
    if (now < until) known[cell] = Occupancy::kOccupied;
  }
  if (stands_in_) known[*stands_in_] = Occupancy::kFree;
  return known;
}

std::optional<Cell> MapKeeper::FirstObstacle(Position from, Position to,
                                             Clock::TimePoint now) const {
  const double length_m = Distance(from, to);
  const double step_m = grid_.cell_size_m / 10.0;
  const int steps = 1 + static_cast<int>(std::ceil(length_m / step_m));
  const Cell own = grid_.PositionToCell(from);
  for (int i = 0; i <= steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    const Cell cell = grid_.PositionToCell(
        {from.x_m + share * (to.x_m - from.x_m), from.y_m + share * (to.y_m - from.y_m)});
    if (cell == own) continue;
    if (!grid_.Contains(cell) || known_[cell] == Occupancy::kOccupied) return cell;
    const auto blocked = blocked_.find(cell);
    if (blocked != blocked_.end() && now < blocked->second) return cell;
  }
  // Within its own radius the robot stands: what is drawn there is a trace of itself, or noise.
  if (map_.data.empty() || length_m <= options_.radius_m) return std::nullopt;
  const double share = options_.radius_m / length_m;
  const Position edge{from.x_m + share * (to.x_m - from.x_m),
                      from.y_m + share * (to.y_m - from.y_m)};
  if (IsCrossed(edge, to)) return grid_.PositionToCell(to);
  return std::nullopt;
}

}  // namespace conav::robot
