#include "sim/physics/image.h"

#include <fmt/format.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <utility>

namespace conav::sim {
namespace {

bool IsWhole(const RgbImage& image) {
  return image.width > 0 && image.height > 0 &&
         image.rgb.size() ==
             static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 3;
}

/// Red and blue change places: OpenCV's codecs take blue first.
cv::Mat Swapped(const cv::Mat& pixels) {
  cv::Mat swapped(pixels.rows, pixels.cols, CV_8UC3);
  const int pairs[] = {0, 2, 1, 1, 2, 0};
  cv::mixChannels(&pixels, 1, &swapped, 1, pairs, 3);
  return swapped;
}

Result<std::vector<std::uint8_t>> Encode(const RgbImage& image, const char* extension,
                                         const std::vector<int>& parameters) {
  if (!IsWhole(image)) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("picture of {}x{} with {} bytes", image.width, image.height, image.rgb.size()));
  }
  const cv::Mat pixels(image.height, image.width, CV_8UC3,
                       const_cast<std::uint8_t*>(image.rgb.data()));
  std::vector<std::uint8_t> bytes;
  try {
    if (cv::imencode(extension, Swapped(pixels), bytes, parameters)) return bytes;
  } catch (const cv::Exception& exception) {
    return Fail(ErrorCode::kUnavailable,
                fmt::format("{} encoder: {}", extension, exception.what()));
  }
  return Fail(ErrorCode::kUnavailable, fmt::format("{} encoder failed", extension));
}

}  // namespace

Result<std::vector<std::uint8_t>> EncodeJpeg(const RgbImage& image, int quality) {
  if (quality < 1 || quality > 100) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("JPEG quality {}; 1 to 100", quality));
  }
  return Encode(image, ".jpg", {cv::IMWRITE_JPEG_QUALITY, quality});
}

Result<std::vector<std::uint8_t>> EncodePng(const RgbImage& image) {
  return Encode(image, ".png", {});
}

Result<RgbImage> DecodeJpeg(const std::vector<std::uint8_t>& jpeg) {
  if (jpeg.empty()) return Fail(ErrorCode::kMalformed, "empty picture");
  cv::Mat pixels;
  try {
    pixels = cv::imdecode(jpeg, cv::IMREAD_COLOR);
  } catch (const cv::Exception& exception) {
    return Fail(ErrorCode::kMalformed, fmt::format("picture: {}", exception.what()));
  }
  if (pixels.empty()) return Fail(ErrorCode::kMalformed, "not a picture");
  const cv::Mat swapped = Swapped(pixels);
  return RgbImage{swapped.cols, swapped.rows,
                  std::vector<std::uint8_t>(swapped.datastart, swapped.dataend)};
}

}  // namespace conav::sim
