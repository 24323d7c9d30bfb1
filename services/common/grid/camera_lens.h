#pragma once

#include "common/grid/visibility.h"

namespace conav {

/// How the camera sits on every robot, fixed by MemoryMaze: 0.9 m above the floor, 0.15 m ahead of
/// the robot's axis, 5.7 degrees down.
inline constexpr double kCameraHeightM = 0.9;
inline constexpr double kCameraForwardM = 0.15;
inline constexpr double kCameraPitchRad = 0.09966865249116204;  // downwards
/// Of the simulated camera: 80 degrees.
inline constexpr double kCameraVerticalFovRad = 1.3962634015954636;

/// Horizontal field of view of a simulated picture of this shape: 2 atan(width / height tan(40
/// deg)).
double HorizontalFov(int width, int height);

/// A camera's picture, undistorted, as its camera_info tells.
struct CameraLens {
  int width = 320;   // pixels
  int height = 192;  // pixels
  double horizontal_fov_rad = HorizontalFov(320, 192);
  double vertical_fov_rad = kCameraVerticalFovRad;
  bool operator==(const CameraLens&) const = default;
};

/// What CastView needs to know of a picture taken at the centre of `cell`; 4 rays per column.
CameraView ViewThrough(const CameraLens& lens, Cell cell, double heading_rad, double cell_size_m);
/// The same for the simulated camera with pictures of `width` x `height`.
CameraView ViewAt(Cell cell, double heading_rad, double cell_size_m, int width, int height);

}  // namespace conav
