#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/grid/visibility.h"
#include "common/runtime/result.h"
#include "sim/physics/robot_world.h"

namespace conav::sim {

/// 8-bit RGB, row-major, row 0 is the upper row; size width * height * 3.
struct RgbImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;
};

/// JPEG of `image`, quality 1..100. Fails (kInvalidArgument) on an empty image or a quality out of
/// range, (kUnavailable) when the codec fails. The same image gives the same bytes.
Result<std::vector<std::uint8_t>> EncodeJpeg(const RgbImage& image, int quality);

struct CameraOptions {
  int width = 320;   // 16..4096
  int height = 192;  // 16..4096
};

/// Off-screen renderer over EGL: on the GPU when the driver offers one, else in software (Mesa
/// llvmpipe); needs no display and no device. Open() takes and frees llvmpipe's most, 72 MiB, and
/// 16 more.
///
/// Threads: owns an OpenGL context: open, use and destroy it on one thread (demanded). It reads the
///          RobotWorld, which must outlive it and must not be stepped during a call.
class Camera {
 public:
  /// Fails with kInvalidArgument (size) or kUnavailable (no EGL; the text says what to install).
  static Result<std::unique_ptr<Camera>> Open(const RobotWorld& world, CameraOptions options);
  ~Camera();
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  /// What `robot` sees now.
  RgbImage Render(int robot);
  /// The model's geom that each pixel of Render(robot) shows, -1 for none, by MuJoCo's segmentation.
  Grid<int> RenderGeoms(int robot);

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
