#include "common/grid/visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

namespace conav {
namespace {

enum class Seen : std::uint8_t { kNot, kFree, kWall };

/// Walks one ray cell by cell (Amanatides and Woo, 1987). Grid coordinates: x to the east in
/// columns, y to the south in rows, cell (r, c) covers [c, c+1) x [r, r+1). `visit` gets the cell
/// and the distance along the ray at which it begins; it returns whether to go on.
template <class Visit>
void WalkRay(double x, double y, double dx, double dy, Visit&& visit) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Cell cell{static_cast<int>(std::floor(y)), static_cast<int>(std::floor(x))};
  const int step_x = dx > 0 ? 1 : -1;
  const int step_y = dy > 0 ? 1 : -1;
  const double delta_x = dx != 0 ? std::abs(1.0 / dx) : kInfinity;
  const double delta_y = dy != 0 ? std::abs(1.0 / dy) : kInfinity;
  double next_x =
      dx != 0 ? ((dx > 0 ? cell.column + 1 - x : x - cell.column) * delta_x) : kInfinity;
  double next_y = dy != 0 ? ((dy > 0 ? cell.row + 1 - y : y - cell.row) * delta_y) : kInfinity;
  double travelled = 0.0;
  while (visit(cell, travelled)) {
    travelled = std::min(next_x, next_y);
    if (next_x < next_y) {
      next_x += delta_x;
      cell.column += step_x;
    } else {
      next_y += delta_y;
      cell.row += step_y;
    }
  }
}

/// `seen` is a window of the map whose first cell is `corner`.
VisibleCells Collect(const Grid<Seen>& seen, Cell corner) {
  VisibleCells cells;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen.values()[i] == Seen::kFree) cells.free.push_back(corner + seen.CellAt(i));
    if (seen.values()[i] == Seen::kWall) cells.walls.push_back(corner + seen.CellAt(i));
  }
  return cells;
}

/// What a view shows of a map of any size, for what it shows: memory kept by a thread, clean but for the
/// box around what was marked since the last Take().
class SeenBox {
 public:
  static SeenBox& For(const OccupancyGrid& map) {
    thread_local SeenBox box;
    if (box.seen_.rows() != map.rows() || box.seen_.columns() != map.columns()) {
      box.seen_ = Grid<Seen>(map.rows(), map.columns(), Seen::kNot);
    }
    box.first_ = {map.rows(), map.columns()};
    box.last_ = {-1, -1};
    return box;
  }

  void Mark(Cell cell, Seen seen) {
    seen_[cell] = seen;
    Include(cell);
  }
  /// The cells that a ray from (x, y) meets before `range`.
  void MarkRay(const OccupancyGrid& map, double x, double y, double dx, double dy, double range) {
    std::optional<Cell> first;
    Cell last;
    WalkRay(x, y, dx, dy, [&](Cell cell, double travelled) {
      if (!map.Contains(cell) || travelled >= range || map[cell] == Occupancy::kUnknown) {
        return false;
      }
      const bool wall = map[cell] == Occupancy::kOccupied;
      seen_[cell] = wall ? Seen::kWall : Seen::kFree;
      if (!first) first = cell;
      last = cell;
      return !wall;
    });
    if (!first) return;
    Include(*first);  // a ray never turns back
    Include(last);
  }

  /// In row-major order.
  VisibleCells Take() {
    VisibleCells cells;
    for (int row = first_.row; row <= last_.row; ++row) {
      for (int column = first_.column; column <= last_.column; ++column) {
        const Seen seen = std::exchange(seen_[{row, column}], Seen::kNot);
        if (seen == Seen::kFree) cells.free.push_back({row, column});
        if (seen == Seen::kWall) cells.walls.push_back({row, column});
      }
    }
    return cells;
  }

 private:
  void Include(Cell cell) {
    first_ = {std::min(first_.row, cell.row), std::min(first_.column, cell.column)};
    last_ = {std::max(last_.row, cell.row), std::max(last_.column, cell.column)};
  }

  Grid<Seen> seen_;
  Cell first_;
  Cell last_;
};

/// The image plane of a camera, at distance 1 along the optical axis.
struct ImagePlane {
  explicit ImagePlane(const CameraView& view)
      : half_width(std::tan(view.horizontal_fov_rad / 2.0)),
        half_height(std::tan(view.vertical_fov_rad / 2.0)),
        sin_pitch(std::sin(view.pitch_rad)),
        cos_pitch(std::cos(view.pitch_rad)),
        height(view.height_cells) {}

  /// Tangent of the widest azimuth: that of the lower corners.
  double WidestTangent() const { return half_width / (cos_pitch - half_height * sin_pitch); }

  /// How far ahead (cells, along the heading) the picture shows an azimuth of this tangent. Row y
  /// of the image plane (up positive) looks cos p + y sin p ahead and sin p - y cos p down, and
  /// shows azimuths up to half_width / ahead.
  double RangeAhead(double tangent) const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    if (std::abs(tangent) * (cos_pitch + half_height * sin_pitch) <= half_width) return kInfinity;
    const double ahead = half_width / std::abs(tangent);
    const double row = (ahead - cos_pitch) / sin_pitch;
    const double down = sin_pitch - row * cos_pitch;
    return down <= 0.0 ? kInfinity : height * ahead / down;
  }

  double half_width;
  double half_height;
  double sin_pitch;
  double cos_pitch;
  double height;
};

}  // namespace

ViewCaster::ViewCaster(const CameraView& view)
    : offset_x_(view.east_offset_cells + view.forward_offset_cells * std::cos(view.heading_rad)),
      offset_y_(view.south_offset_cells - view.forward_offset_cells * std::sin(view.heading_rad)) {
  DEMAND(view.rays > 0, view.rays);
  DEMAND(view.pitch_rad >= 0.0 && view.pitch_rad + view.vertical_fov_rad / 2.0 < 1.5,
         view.pitch_rad, view.vertical_fov_rad);
  const ImagePlane plane(view);
  // Image columns are evenly spaced on the image plane, so rays are too.
  const double widest = plane.WidestTangent();
  const int rays = static_cast<int>(std::ceil(view.rays * widest / plane.half_width));
  for (int i = 0; i < rays; ++i) {
    const double tangent = widest * (1.0 - 2.0 * (i + 0.5) / rays);
    const double heading_rad = view.heading_rad + std::atan(tangent);
    rays_.push_back(
        {std::cos(heading_rad), -std::sin(heading_rad),
         std::min(plane.RangeAhead(tangent) * std::hypot(1.0, tangent), view.range_cells)});
  }
}

VisibleCells ViewCaster::Cast(const OccupancyGrid& map, Cell cell) const {
  DEMAND(map.Contains(cell), cell.row, cell.column);
  SeenBox& seen = SeenBox::For(map);
  seen.Mark(cell, Seen::kFree);
  const double x = cell.column + 0.5 + offset_x_;
  const double y = cell.row + 0.5 + offset_y_;
  for (const Ray& ray : rays_) seen.MarkRay(map, x, y, ray.dx, ray.dy, ray.range_cells);
  return seen.Take();
}

VisibleCells CastView(const OccupancyGrid& map, const CameraView& view) {
  return ViewCaster(view).Cast(map, view.cell);
}

VisibleCells CastRange(const OccupancyGrid& truth, Cell cell, double range_cells) {
  DEMAND(truth.Contains(cell) && range_cells >= 0.0, cell.row, cell.column, range_cells);
  const int reach = static_cast<int>(std::min(
      std::ceil(range_cells), static_cast<double>(std::max(truth.rows(), truth.columns()))));
  const Cell corner{std::max(0, cell.row - reach), std::max(0, cell.column - reach)};
  const Cell end{std::min(truth.rows(), cell.row + reach + 1),
                 std::min(truth.columns(), cell.column + reach + 1)};
  Grid<Seen> seen(end.row - corner.row, end.column - corner.column, Seen::kNot);
  Grid<std::uint8_t> within(reach + 1, reach + 1);
  for (std::size_t i = 0; i < within.size(); ++i) {
    const Cell away = within.CellAt(i);
    within.values()[i] = std::hypot(away.row, away.column) <= range_cells + 1e-9 ? 1 : 0;
  }
  const auto visit = [&](Cell at, double) {
    const Cell in_window = at - corner;
    if (!seen.Contains(in_window)) return false;
    const Cell away = at - cell;
    if (within.values()[within.IndexOf({std::abs(away.row), std::abs(away.column)})] == 0) {
      return false;
    }
    const Occupancy occupancy = truth.values()[truth.IndexOf(at)];
    if (occupancy == Occupancy::kUnknown) return false;
    const bool wall = occupancy == Occupancy::kOccupied;
    seen.values()[seen.IndexOf(in_window)] = wall ? Seen::kWall : Seen::kFree;
    return !wall;
  };
  const int rays = std::max(64, static_cast<int>(std::ceil(range_cells * 64)));
  for (int i = 0; i < rays; ++i) {
    // Half a step off the axes, so that no ray runs exactly along an edge or through a corner.
    const double heading_rad = 2.0 * std::numbers::pi * (i + 0.5) / rays;
    WalkRay(cell.column + 0.5, cell.row + 0.5, std::cos(heading_rad), -std::sin(heading_rad),
            visit);
  }
  return Collect(seen, corner);
}

double HorizontalFov(int width, int height) {
  return 2.0 * std::atan(std::tan(kCameraVerticalFovRad / 2.0) * width / height);
}

CameraView ViewThrough(const CameraLens& lens, Cell cell, double heading_rad, double cell_size_m) {
  CameraView view;
  view.cell = cell;
  view.heading_rad = heading_rad;
  view.horizontal_fov_rad = lens.horizontal_fov_rad;
  view.rays = 4 * lens.width;
  view.forward_offset_cells = kCameraForwardM / cell_size_m;
  view.height_cells = kCameraHeightM / cell_size_m;
  view.pitch_rad = kCameraPitchRad;
  view.vertical_fov_rad = lens.vertical_fov_rad;
  return view;
}

CameraView ViewAt(Cell cell, double heading_rad, double cell_size_m, int width, int height) {
  const CameraLens lens{width, height, HorizontalFov(width, height), kCameraVerticalFovRad};
  return ViewThrough(lens, cell, heading_rad, cell_size_m);
}

}  // namespace conav
