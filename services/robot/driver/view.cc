#include "robot/driver/view.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string_view>

namespace conav::robot {
namespace {

constexpr int kMostRays = 2560;
/// The sum of pitch and half the field of view that a caster takes.
constexpr double kLowestRayRad = 1.49;
constexpr double kMillimetre = 0.001;

Error BadImage(const RawImage& image, std::string_view what) {
  return {
      ErrorCode::kMalformed,
      fmt::format("image of {}x{} pixels, step {}, encoding '{}', {} bytes: {}", image.width,
                  image.height, image.step, image.encoding.substr(0, 40), image.data.size(), what)};
}

bool IsWhole(const RawImage& image, int bytes_per_pixel) {
  return image.width > 0 && image.height > 0 &&
         image.step >=
             static_cast<std::size_t>(image.width) * static_cast<std::size_t>(bytes_per_pixel) &&
         image.data.size() >= image.step * static_cast<std::size_t>(image.height);
}

/// Where a pixel of this encoding has red, green and blue.
struct Channels {
  int bytes;
  int red, green, blue;
};

std::optional<Channels> ChannelsOf(const std::string& encoding) {
  if (encoding == "rgb8") return Channels{3, 0, 1, 2};
  if (encoding == "bgr8") return Channels{3, 2, 1, 0};
  if (encoding == "rgba8") return Channels{4, 0, 1, 2};
  if (encoding == "bgra8") return Channels{4, 2, 1, 0};
  if (encoding == "mono8") return Channels{1, 0, 0, 0};
  return std::nullopt;
}

Result<Picture> Encode(const cv::Mat& pixels, int jpeg_quality) {
  Picture picture{
      static_cast<std::uint32_t>(pixels.cols), static_cast<std::uint32_t>(pixels.rows), {}};
  try {
    if (cv::imencode(".jpg", pixels, picture.jpeg, {cv::IMWRITE_JPEG_QUALITY, jpeg_quality})) {
      return picture;
    }
  } catch (const cv::Exception&) {
  }
  return Fail(ErrorCode::kMalformed, "the JPEG encoder failed");
}

/// Metres at a pixel; not above 0, or no number, where nothing was measured.
double DepthAt(const RawImage& image, int row, int column) {
  const bool is_float = image.encoding == "32FC1";
  const std::size_t bytes = is_float ? 4 : 2;
  const std::uint8_t* pixel = image.data.data() + static_cast<std::size_t>(row) * image.step +
                              static_cast<std::size_t>(column) * bytes;
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < bytes; ++i) {
    const std::size_t shift = 8 * (image.big_endian ? bytes - 1 - i : i);
    value |= static_cast<std::uint32_t>(pixel[i]) << shift;
  }
  if (!is_float) return value * kMillimetre;
  float metres = 0.0F;
  std::memcpy(&metres, &value, sizeof metres);
  return static_cast<double>(metres);
}

void DropBehind(std::vector<Cell>& cells, const GridGeometry& grid, const CameraLens& lens,
                const Pose& camera, const DepthProfile& depth) {
  const double half_width = std::tan(lens.horizontal_fov_rad / 2.0);
  std::erase_if(cells, [&](Cell cell) {
    const Position local = Inverse(camera) * grid.CellToPosition(cell);
    if (local.x_m <= 0.0) return false;
    // Columns are evenly spaced on the image plane, the left one first; y is to the left.
    const double share = std::clamp(0.5 - local.y_m / local.x_m / half_width / 2.0, 0.0, 1.0);
    const auto column = std::min(
        static_cast<std::size_t>(share * static_cast<double>(depth.size())), depth.size() - 1);
    return local.x_m > depth[column] + grid.cell_size_m;
  });
}

}  // namespace

Result<Picture> ToPicture(std::vector<std::uint8_t> compressed, int jpeg_quality) {
  // OpenCV's own signatures: what it takes for DICOM would go to GDCM, which aborts on bad ones.
  const std::string_view bytes(reinterpret_cast<const char*>(compressed.data()), compressed.size());
  const bool is_jpeg = bytes.starts_with("\xFF\xD8\xFF");
  cv::Mat pixels;
  try {
    if (is_jpeg || bytes.starts_with("\x89PNG\r\n\x1A\n")) {
      pixels = cv::imdecode(compressed, cv::IMREAD_COLOR);
    }
  } catch (const std::exception&) {  // OpenCV's, and of memory
  }
  if (pixels.empty()) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("image of {} bytes: not a JPEG or PNG, or torn", compressed.size()));
  }
  if (!is_jpeg) return Encode(pixels, jpeg_quality);
  return Picture{static_cast<std::uint32_t>(pixels.cols), static_cast<std::uint32_t>(pixels.rows),
                 std::move(compressed)};
}

Result<Picture> ToPicture(const RawImage& image, int jpeg_quality) {
  const auto channels = ChannelsOf(image.encoding);
  if (!channels) {
    return tl::unexpected(BadImage(image, "known are rgb8, bgr8, rgba8, bgra8 and mono8"));
  }
  if (!IsWhole(image, channels->bytes)) return tl::unexpected(BadImage(image, "incomplete"));
  cv::Mat pixels(image.height, image.width, CV_8UC3);
  for (int row = 0; row < image.height; ++row) {
    const std::uint8_t* from = image.data.data() + static_cast<std::size_t>(row) * image.step;
    for (int column = 0; column < image.width; ++column, from += channels->bytes) {
      pixels.at<cv::Vec3b>(row, column) = {from[channels->blue], from[channels->green],
                                           from[channels->red]};
    }
  }
  return Encode(pixels, jpeg_quality);
}

Result<DepthProfile> ToDepthProfile(const RawImage& image) {
  const bool known = image.encoding == "32FC1" || image.encoding == "16UC1";
  if (!known) return tl::unexpected(BadImage(image, "known for depth are 16UC1 and 32FC1"));
  if (!IsWhole(image, image.encoding == "32FC1" ? 4 : 2)) {
    return tl::unexpected(BadImage(image, "incomplete"));
  }
  const int band = std::max(1, image.height / 20);
  const int first = std::max(0, image.height / 2 - band);
  const int last = std::min(image.height - 1, image.height / 2 + band);
  DepthProfile profile;
  std::vector<double> column_m;
  for (int column = 0; column < image.width; ++column) {
    column_m.clear();
    for (int row = first; row <= last; ++row) {
      const double metres = DepthAt(image, row, column);
      if (std::isfinite(metres) && metres > 0.0) column_m.push_back(metres);
    }
    if (column_m.empty()) {
      profile.push_back(std::numeric_limits<double>::infinity());
      continue;
    }
    const auto middle = column_m.begin() + static_cast<std::ptrdiff_t>(column_m.size() / 2);
    std::nth_element(column_m.begin(), middle, column_m.end());
    profile.push_back(*middle);
  }
  return profile;
}

VisibleCells Recognise(const OccupancyGrid& known, const GridGeometry& grid, const CameraLens& lens,
                       const ViewOptions& options, const Pose& at, const DepthProfile& depth) {
  CameraView view =
      ViewThrough(lens, grid.PositionToCell(at.position), at.heading_rad, grid.cell_size_m);
  const Position middle = grid.CellToPosition(view.cell);
  view.east_offset_cells = (at.position.x_m - middle.x_m) / grid.cell_size_m;
  view.south_offset_cells = (middle.y_m - at.position.y_m) / grid.cell_size_m;
  view.rays = std::min(view.rays, kMostRays);
  view.forward_offset_cells = options.forward_m / grid.cell_size_m;
  view.height_cells = options.height_m / grid.cell_size_m;
  view.pitch_rad = std::clamp(options.pitch_rad, 0.0, kLowestRayRad - lens.vertical_fov_rad / 2.0);
  view.range_cells = options.range_m / grid.cell_size_m;
  VisibleCells visible = CastView(known, view);
  if (depth.empty()) return visible;
  const Pose camera = at * Pose{{options.forward_m, 0.0}, 0.0};
  DropBehind(visible.free, grid, lens, camera, depth);
  DropBehind(visible.walls, grid, lens, camera, depth);
  return visible;
}

}  // namespace conav::robot
