#include "robot/driver/view.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>
#include <limits>
#include <opencv2/imgcodecs.hpp>

namespace conav::robot {
namespace {

constexpr GridGeometry kHallGrid{5, 9, 1.0};
const CameraLens kLens{160, 120, 1.2, 0.9};

OccupancyGrid Hall() {
  OccupancyGrid hall(5, 9, Occupancy::kFree);
  hall[{2, 6}] = Occupancy::kOccupied;
  return hall;
}

TEST_CASE("a picture shows the free cells in front of the camera, and the first wall",
          "[robot][driver]") {
  const Pose west_end{kHallGrid.CellToPosition({2, 0}), 0.0};
  const VisibleCells all = Recognise(Hall(), kHallGrid, kLens, {.range_m = 50.0}, west_end, {});
  CHECK(Contains(all.free, Cell{2, 3}));
  CHECK(all.walls == std::vector<Cell>{{2, 6}});
  CHECK_FALSE(Contains(all.free, Cell{2, 7}));  // behind it
  const VisibleCells near = Recognise(Hall(), kHallGrid, kLens, {.range_m = 3.0}, west_end, {});
  CHECK(Contains(near.free, Cell{2, 2}));
  CHECK_FALSE(Contains(near.free, Cell{2, 5}));
  CHECK(near.walls.empty());
  OccupancyGrid unknown = Hall();
  unknown[{2, 3}] = Occupancy::kUnknown;
  const VisibleCells ended = Recognise(unknown, kHallGrid, kLens, {.range_m = 50.0}, west_end, {});
  CHECK_FALSE(Contains(ended.walls, Cell{2, 6}));
  const Pose back{west_end.position, 3.14159};
  CHECK(Recognise(Hall(), kHallGrid, kLens, {}, back, {}).walls.empty());
}

TEST_CASE("nothing behind a measured depth counts", "[robot][driver]") {
  const Pose west_end{kHallGrid.CellToPosition({2, 0}), 0.0};
  const double infinity = std::numeric_limits<double>::infinity();
  DepthProfile depth(160, infinity);
  // Somebody stands 2 m ahead, in the middle of the picture.
  for (std::size_t column = 70; column < 90; ++column) depth[column] = 2.0;
  const VisibleCells seen = Recognise(Hall(), kHallGrid, kLens, {.range_m = 50.0}, west_end, depth);
  CHECK(Contains(seen.free, Cell{2, 2}));
  CHECK_FALSE(Contains(seen.free, Cell{2, 5}));
  CHECK(seen.walls.empty());
  CHECK(Contains(seen.free, Cell{0, 5}));  // to the left of them
}

TEST_CASE("any lens that camera_info may bring can be cast", "[robot][driver]") {
  const CameraLens wide{16384, 16384, 2.6, 2.6};
  const VisibleCells seen = Recognise(Hall(), kHallGrid, wide, {.height_m = 0.0, .pitch_rad = 1.0},
                                      {kHallGrid.CellToPosition({2, 0}), 0.0}, {});
  CHECK_FALSE(seen.free.empty());
}

RawImage Raw(const std::string& encoding, std::vector<std::uint8_t> pixel) {
  RawImage image{4, 3, pixel.size() * 4 + 2, encoding, false, {}};  // rows end with two bytes more
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      image.data.insert(image.data.end(), pixel.begin(), pixel.end());
    }
    image.data.insert(image.data.end(), {9, 9});
  }
  return image;
}

TEST_CASE("raw pictures of ROS's common encodings become JPEG, in the right colours",
          "[robot][driver]") {
  struct Row {
    std::string encoding;
    std::vector<std::uint8_t> pixel;
  };
  const Row row = GENERATE(Row{"rgb8", {250, 10, 20}}, Row{"bgr8", {20, 10, 250}},
                           Row{"rgba8", {250, 10, 20, 255}}, Row{"bgra8", {20, 10, 250, 255}});
  const auto picture = ToPicture(Raw(row.encoding, row.pixel), 95);
  REQUIRE(picture);
  CHECK(picture->width == 4);
  CHECK(picture->height == 3);
  const cv::Mat decoded = cv::imdecode(picture->jpeg, cv::IMREAD_COLOR);
  CHECK(decoded.at<cv::Vec3b>(1, 1)[2] > 220);  // red
  CHECK(decoded.at<cv::Vec3b>(1, 1)[0] < 60);
  CHECK(ToPicture(Raw("mono8", {100}), 95));
  // A JPEG goes through byte for byte.
  const auto same = ToPicture(picture->jpeg, 10);
  REQUIRE(same);
  CHECK(same->jpeg == picture->jpeg);
  CHECK(same->width == 4);
}

TEST_CASE("pictures that cannot be are refused", "[robot][driver]") {
  CHECK_FALSE(ToPicture(std::vector<std::uint8_t>{}, 90));
  CHECK_FALSE(ToPicture(std::vector<std::uint8_t>{0xFF, 0xD8, 0xFF, 0xE0, 1, 2}, 90));
  // OpenCV gave this to its decoder of DICOM, which aborted.
  std::vector<std::uint8_t> dicom(128, 0x0B);
  std::ranges::copy(std::vector<std::uint8_t>{0xFF, 0xD8, 0x0B}, dicom.begin());
  for (const std::uint8_t byte : {'D', 'I', 'C', 'M', '\0', '\xFE', '\x1C'}) dicom.push_back(byte);
  CHECK_FALSE(ToPicture(dicom, 90));
  CHECK_FALSE(ToPicture(Raw("yuv422", {1, 2}), 90));
  RawImage torn = Raw("rgb8", {1, 2, 3});
  torn.data.resize(20);
  CHECK_FALSE(ToPicture(torn, 90));
  RawImage lying = Raw("rgb8", {1, 2, 3});
  lying.step = 2;
  CHECK_FALSE(ToPicture(lying, 90));
  CHECK_FALSE(ToPicture(RawImage{0, 0, 0, "rgb8", false, {}}, 90));
  CHECK_FALSE(ToDepthProfile(Raw("rgb8", {1, 2, 3})));
}

TEST_CASE("depth is read in millimetres or metres, of either byte order", "[robot][driver]") {
  const auto millimetres = ToDepthProfile(Raw("16UC1", {0xDC, 0x05}));  // 1500
  REQUIRE(millimetres);
  REQUIRE(millimetres->size() == 4);
  CHECK((*millimetres)[0] == Approx(1.5));
  RawImage swapped = Raw("16UC1", {0x05, 0xDC});
  swapped.big_endian = true;
  CHECK((*ToDepthProfile(swapped))[3] == Approx(1.5));
  std::vector<std::uint8_t> bytes(4);
  const float metres = 2.5F;
  std::memcpy(bytes.data(), &metres, 4);
  CHECK((*ToDepthProfile(Raw("32FC1", bytes)))[1] == Approx(2.5));
  CHECK((*ToDepthProfile(Raw("16UC1", {0, 0})))[1] == std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace conav::robot
