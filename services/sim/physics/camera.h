#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/grid/visibility.h"
#include "sim/physics/image.h"
#include "sim/physics/robot_world.h"

namespace conav::sim {

/// The robot's camera, fixed by MemoryMaze: 0.9 m above the floor, 0.15 m ahead of the robot's
/// axis, 5.7 degrees down, 80 degrees vertical field of view.
inline constexpr double kCameraHeightM = 0.9;
inline constexpr double kCameraForwardM = 0.15;
inline constexpr double kCameraVerticalFovRad = 1.3962634015954636;
inline constexpr double kCameraPitchRad = 0.09966865249116204;  // downwards

/// Horizontal field of view of a picture of this shape: 2 atan(width / height tan(40 deg)).
double HorizontalFov(int width, int height);

/// What CastView needs to know of a picture of `width` x `height` taken at the centre of `cell`.
CameraView ViewAt(Cell cell, double heading_rad, double cell_size_m, int width, int height);

struct CameraOptions {
  int width = 320;   // 16..4096
  int height = 192;  // 16..4096
};

enum class PixelKind : std::uint8_t { kNone, kFloor, kWall, kGoal, kRobot };

/// What one pixel shows. `cell` for floor and wall, `index` for goal and robot.
struct PixelLabel {
  PixelKind kind = PixelKind::kNone;
  Cell cell;
  int index = -1;
};

/// Off-screen renderer over EGL: on the GPU when the driver offers one, else in software (Mesa
/// llvmpipe); needs no display and no device.
///
/// Threads: owns an OpenGL context: open, use and destroy it on one thread (demanded). It reads the
/// RobotWorld, which must outlive it and must not be stepped during a call.
class Camera {
 public:
  /// Fails with kInvalidArgument (size) or kUnavailable (no EGL; the text says what to install).
  static Result<std::unique_ptr<Camera>> Open(const RobotWorld& world, CameraOptions options);
  ~Camera();
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  /// What `robot` sees now.
  RgbImage Render(int robot);
  /// The maze from above, north up, as large as fits.
  RgbImage RenderTop();
  /// What each pixel of Render(robot) shows, by MuJoCo's segmentation. Row 0 is the upper row.
  Grid<PixelLabel> RenderSegmentation(int robot);

  const CameraOptions& options() const { return options_; }
  /// The OpenGL renderer's name, for the log.
  const std::string& renderer_name() const;

 private:
  struct Context;
  Camera(const RobotWorld& world, CameraOptions options, std::unique_ptr<Context> context);

  const RobotWorld& world_;
  CameraOptions options_;
  std::unique_ptr<Context> context_;
};

}  // namespace conav::sim
