#pragma once

#include <limits>
#include <vector>

#include "common/grid/geometry.h"
#include "common/grid/grid.h"

namespace conav {

/// The cells that one picture shows. Each list is sorted row-major without repeats.
struct VisibleCells {
  std::vector<Cell> free;
  std::vector<Cell> walls;
  bool operator==(const VisibleCells&) const = default;
};

/// A camera at a cell's centre, or next to it, moved forward along its heading.
struct CameraView {
  Cell cell;
  /// Offset of the robot's axis from the cell's centre, in cells.
  double east_offset_cells = 0.0;
  double south_offset_cells = 0.0;
  double heading_rad = 0.0;
  double horizontal_fov_rad = 1.3962634;
  /// Rays over the field of view; at least 4 per image column for a real picture.
  int rays = 1280;
  /// Camera ahead of the cell's centre, in cells (0.15 m on 2 m cells).
  double forward_offset_cells = 0.075;
  /// A camera that looks down shows more at the sides close by than far away, because its lower
  /// rows are wider. 0.9 m on 2 m cells; downwards positive, at least 0.
  double height_cells = 0.45;
  double pitch_rad = 0.09966865;
  double vertical_fov_rad = 1.3962634;
  /// How far the view reaches, from the camera.
  double range_cells = std::numeric_limits<double>::infinity();
};

/// A camera with a heading. Computes its rays once and casts them from any cell. Ignores
/// `view.cell`. Threads: safe to use concurrently.
class ViewCaster {
 public:
  explicit ViewCaster(const CameraView& view);

  /// As CastView() from `cell`.
  VisibleCells Cast(const OccupancyGrid& map, Cell cell) const;

 private:
  struct Ray {
    double dx, dy;  // unit vector: columns to the east, rows to the south
    double range_cells;
  };

  double offset_x_;  // of the camera from the cell's centre
  double offset_y_;
  std::vector<Ray> rays_;
};

/// Cells that `view` shows on `map`, by casting rays through the cells (DDA). A ray sees each cell
/// it enters as free; the first occupied cell it sees as a wall and ends there; an unknown cell
/// ends it unseen. The camera's own cell counts as seen. Walls are higher than the camera, so two
/// dimensions are exact; only rays outside the horizon's field of view have a range, set by how far
/// down the picture they are. Source: paper section 4 (captured environment grids).
VisibleCells CastView(const OccupancyGrid& map, const CameraView& view);

/// Cells that a range sensor at the centre of `cell` sees in all directions up to `range_cells`
/// (Euclidean distance between cell centres), occluded by walls. `truth` has no unknown cells
/// within reach. Source: paper section 3, "observes its surroundings up to a distance d".
VisibleCells CastRange(const OccupancyGrid& truth, Cell cell, double range_cells);

/// How the camera sits on every robot, fixed by MemoryMaze: 0.9 m above the floor, 0.15 m ahead of
/// the robot's axis, 5.7 degrees down.
inline constexpr double kCameraHeightM = 0.9;
inline constexpr double kCameraForwardM = 0.15;
inline constexpr double kCameraPitchRad = 0.09966865249116204;  // downwards
/// Field of view of the simulated camera: 80 degrees.
inline constexpr double kCameraVerticalFovRad = 1.3962634015954636;

/// Horizontal field of view of a simulated picture of this shape: 2 atan(width / height tan(40
/// deg)).
double HorizontalFov(int width, int height);

/// A camera's picture, undistorted, as described by its camera_info.
struct CameraLens {
  int width = 320;   // pixels
  int height = 192;  // pixels
  double horizontal_fov_rad = HorizontalFov(320, 192);
  double vertical_fov_rad = kCameraVerticalFovRad;
  bool operator==(const CameraLens&) const = default;
};

/// The CameraView of a picture taken at the centre of `cell`; 4 rays per column.
CameraView ViewThrough(const CameraLens& lens, Cell cell, double heading_rad, double cell_size_m);
/// The same for the simulated camera with pictures of `width` x `height`.
CameraView ViewAt(Cell cell, double heading_rad, double cell_size_m, int width, int height);

}  // namespace conav
