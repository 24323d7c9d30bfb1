#pragma once

#include <cstdint>
#include <vector>

#include "common/runtime/result.h"

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
/// The picture in a JPEG; fails with kMalformed.
Result<RgbImage> DecodeJpeg(const std::vector<std::uint8_t>& jpeg);
/// Lossless PNG file bytes. Fails as EncodeJpeg.
Result<std::vector<std::uint8_t>> EncodePng(const RgbImage& image);

}  // namespace conav::sim
