#pragma once

#include <string>
#include <string_view>

namespace conav {

/// A robot's frames (REP-105), each the parent of the next. `odom` and `base_link` are on the floor,
/// `base_link` below the robot's axis. The camera looks along x of camera_link and, as REP-103 has
/// it, along z of camera_optical_frame (x right, y down). Images and camera_info are in the last.
inline constexpr std::string_view kMapFrame = "map";
inline constexpr std::string_view kOdometryFrame = "odom";
inline constexpr std::string_view kBaseFrame = "base_link";
inline constexpr std::string_view kCameraFrame = "camera_link";
inline constexpr std::string_view kOpticalFrame = "camera_optical_frame";

/// The id of one of `robot`'s frames: "r1/base_link" where robots share a tree, the plain id for an
/// empty `robot`. "map" is the same for all.
inline std::string FrameId(std::string_view robot, std::string_view frame) {
  if (robot.empty() || frame == kMapFrame) return std::string(frame);
  return std::string(robot).append("/").append(frame);
}

/// Where a frame sits in its parent: metres; radians about the parent's x, then y, then z (as in
/// URDF).
struct FramePose {
  double x_m = 0.0, y_m = 0.0, z_m = 0.0;
  double roll_rad = 0.0, pitch_rad = 0.0, yaw_rad = 0.0;
};

}  // namespace conav
