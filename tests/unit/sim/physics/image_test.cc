#include <catch2/catch.hpp>

#include "sim/physics/camera.h"

namespace conav::sim {
namespace {

/// Left half red, right half blue.
RgbImage TwoColors(int width, int height) {
  RgbImage image{width, height, {}};
  for (int i = 0; i < width * height; ++i) {
    const bool left = i % width < width / 2;
    for (const int value : {left ? 200 : 20, 30, left ? 20 : 200}) {
      image.rgb.push_back(static_cast<std::uint8_t>(value));
    }
  }
  return image;
}

TEST_CASE("a JPEG decodes to its size and colours", "[sim][physics]") {
  const RgbImage image = TwoColors(320, 192);
  const auto jpeg = EncodeJpeg(image, 90);
  REQUIRE(jpeg);
  const auto decoded = DecodeJpeg(*jpeg);
  REQUIRE(decoded);
  CHECK(decoded->width == 320);
  CHECK(decoded->height == 192);
  CHECK(static_cast<int>(decoded->rgb[0]) == Approx(200).margin(8));
  CHECK(static_cast<int>(decoded->rgb[2]) == Approx(20).margin(8));
  CHECK(EncodeJpeg(image, 90).value() == *jpeg);
}

TEST_CASE("a lower JPEG quality gives fewer bytes", "[sim][physics]") {
  RgbImage image = TwoColors(320, 192);
  for (std::size_t i = 0; i < image.rgb.size(); ++i) {
    image.rgb[i] = static_cast<std::uint8_t>(image.rgb[i] ^ (i * 2654435761U >> 28));
  }
  CHECK(EncodeJpeg(image, 20)->size() < EncodeJpeg(image, 95)->size());
}

TEST_CASE("pictures that are not whole and bytes that are no picture are refused",
          "[sim][physics]") {
  CHECK(EncodeJpeg({}, 90).error().code == ErrorCode::kInvalidArgument);
  CHECK(EncodeJpeg({2, 2, {1, 2, 3}}, 90).error().code == ErrorCode::kInvalidArgument);
  CHECK(EncodeJpeg(TwoColors(8, 8), 0).error().code == ErrorCode::kInvalidArgument);
  CHECK(EncodeJpeg(TwoColors(8, 8), 101).error().code == ErrorCode::kInvalidArgument);
  CHECK(DecodeJpeg({}).error().code == ErrorCode::kMalformed);
  CHECK(DecodeJpeg({1, 2, 3, 4}).error().code == ErrorCode::kMalformed);
}

}  // namespace
}  // namespace conav::sim
