#include "common/grid/camera_lens.h"

#include <cmath>

namespace conav {

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
