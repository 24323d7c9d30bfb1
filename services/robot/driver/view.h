#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "common/grid/visibility.h"
#include "common/runtime/result.h"
#include "robot/driver/alignment.h"

namespace conav::robot {

/// How the camera sits on the robot, and what of its pictures counts.
struct ViewOptions {
  double range_m = 5.0;  // how far free cells and walls are recognised
  double forward_m = 0.1;
  double height_m = 0.5;
  double pitch_rad = 0.0;  // downwards
};

/// An uncompressed picture as sensor_msgs/Image carries it: rows of `step` bytes, the upper one first.
struct RawImage {
  int width = 0;
  int height = 0;
  std::size_t step = 0;
  std::string encoding;
  bool big_endian = false;
  std::vector<std::uint8_t> data;
};

struct Picture {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> jpeg;
};

/// How far the camera sees in each column of its picture, metres along the optical axis, from left to
/// right; infinite where nothing was measured. Empty = no depth.
using DepthProfile = std::vector<double>;

/// A JPEG goes through as it is; another format that OpenCV decodes becomes one. Errors: kMalformed.
Result<Picture> ToPicture(std::vector<std::uint8_t> compressed, int jpeg_quality);
/// Of encoding rgb8, bgr8, rgba8, bgra8, mono8. Errors: kMalformed (size, encoding).
Result<Picture> ToPicture(const RawImage& image, int jpeg_quality);
/// Of encoding 16UC1 (mm) or 32FC1 (m): the median of the rows around the middle. Errors: kMalformed.
Result<DepthProfile> ToDepthProfile(const RawImage& image);

/// The cells that a picture taken by a robot `at` this pose shows, by casting rays through what is known;
/// unknown cells end a ray. With depth, nothing behind what was measured counts.
/// Shapes: `known` on the cells of `grid`, which holds the robot.
VisibleCells Recognise(const OccupancyGrid& known, const GridGeometry& grid, const CameraLens& lens,
                       const ViewOptions& options, const Pose& at, const DepthProfile& depth);

}  // namespace conav::robot
