#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>

#include "common/runtime/file.h"
#include "sim/world/world_site.h"
#include "support/temporary_folder.h"

namespace conav::sim {
namespace {

namespace fs = std::filesystem;

class Images : public test::TemporaryFolder {
 public:
  fs::path Write(const std::string& name, const cv::Mat& image) const {
    REQUIRE(cv::imwrite((*this / name).string(), image));
    return *this / name;
  }
};

/// A lake of 10 x 12 pixels between banks, `low` in `high`, with a strait of two rows in the middle.
cv::Mat TwoLakes(int type, double low, double high) {
  cv::Mat image(14, 26, type, cv::Scalar(high));
  image(cv::Rect(2, 2, 9, 10)).setTo(cv::Scalar(low));
  image(cv::Rect(15, 2, 9, 10)).setTo(cv::Scalar(low));
  image(cv::Rect(11, 6, 4, 2)).setTo(cv::Scalar(low));
  return image;
}

long Water(const OccupancyGrid& map) { return std::ranges::count(map.values(), Occupancy::kFree); }

TEST_CASE("height maps of 8 and 16 bits become water and land", "[height_map]") {
  const Images images;
  const HeightMapOptions eight{images.Write("a.png", TwoLakes(CV_8UC1, 90, 200)), 100.0, 1.0};
  const auto map = LoadHeightMap(eight, {.cell_size_m = 1.0});
  REQUIRE(map);
  CHECK(map->cells.rows() == 14);
  CHECK(Water(map->cells) == 2 * 90 + 8);
  CHECK(map->cells[{6, 12}] == Occupancy::kFree);
  CHECK(map->cells[{5, 12}] == Occupancy::kOccupied);
  CHECK(map->heights[{0, 0}] == Approx(kHighestLandM));
  CHECK(map->heights[{6, 12}] < 0.0F);
  for (const char* name : {"b.png", "b.tiff"}) {
    const HeightMapOptions deep{images.Write(name, TwoLakes(CV_16UC1, 900, 42000)), 1000.0, 1.0};
    const auto sixteen = LoadHeightMap(deep, {.cell_size_m = 1.0});
    REQUIRE(sixteen);
    CHECK(sixteen->cells == map->cells);
  }
}

TEST_CASE("height maps are resampled with their scale", "[height_map]") {
  const Images images;
  const HeightMapOptions map{images.Write("a.png", TwoLakes(CV_8UC1, 90, 200)), 100.0, 2.0};
  const auto finer = LoadHeightMap(map, {.cell_size_m = 0.5});
  REQUIRE(finer);
  CHECK(finer->cells.rows() == 56);
  CHECK(finer->cells.columns() == 104);
  CHECK(Water(finer->cells) == 16 * (2 * 90 + 8));
  const auto coarser = LoadHeightMap(map, {.cell_size_m = 4.0});
  REQUIRE(coarser);
  CHECK(coarser->cells.rows() == 7);
  CHECK(coarser->cells[{3, 6}] == Occupancy::kFree);
}

TEST_CASE("unusable height maps are refused with the reason", "[height_map]") {
  const Images images;
  REQUIRE(WriteFile(images / "text.png", "not an image"));
  cv::Mat real(20, 20, CV_32FC1, cv::Scalar(3.0));
  const cv::Mat lakes = TwoLakes(CV_8UC1, 90, 200);
  using Row = std::tuple<HeightMapOptions, MapFileOptions, ErrorCode, std::string>;
  for (const auto& [map, file, code, text] :
       {Row{{images / "none.png"}, {}, ErrorCode::kIo, "none.png"},
        Row{{images / "text.png"}, {}, ErrorCode::kIo, "not an image"},
        Row{{images.Write("c.png", cv::Mat(9, 9, CV_8UC3))},
            {},
            ErrorCode::kInvalidArgument,
            "3 channels"},
        Row{{images.Write("f.tiff", real)}, {}, ErrorCode::kInvalidArgument, "32 bits"},
        Row{{images.Write("l.png", lakes), 201.0}, {}, ErrorCode::kInvalidArgument, "no land"},
        Row{{images / "l.png", 90.0},
            {},
            ErrorCode::kInvalidArgument,
            "no water: the pixels are 90"},
        Row{{images / "l.png", 100.0, 50.0},
            {.cell_size_m = 0.1},
            ErrorCode::kOutOfRange,
            "would do"}}) {
    INFO(text);
    const auto refused = LoadHeightMap(map, file);
    REQUIRE(!refused);
    CHECK(refused.error().code == code);
    CHECK_THAT(refused.error().text, Catch::Contains(text));
  }
}

TEST_CASE("a map too small for its robots is refused with a radius that would do", "[height_map]") {
  const Images images;
  WorldOptions options;
  options.height_map = {images.Write("a.png", TwoLakes(CV_8UC1, 90, 200)), 100.0, 1.0};
  options.cell_size_m = 1.0;
  options.wrong_share = 0.05;
  options.starts = {{6, 5}};
  options.goals = {{6, 20}};
  CHECK(MakeWorldSpec(options));
  options.robot_radius_m = 1.0;  // the strait is 2 m wide
  const auto narrow = MakeWorldSpec(options);
  REQUIRE(!narrow);
  CHECK(narrow.error().code == ErrorCode::kInvalidArgument);
  CHECK_THAT(narrow.error().text, Catch::Contains("radius of 0.45 m would do"));
  CHECK_THAT(narrow.error().text, Catch::Contains("(6,20)"));
  options.robot_radius_m = 0.45;
  CHECK(MakeWorldSpec(options));
  options.robot_radius_m = 2.0;
  options.cell_size_m = 3.0;
  options.starts.clear();
  options.goals.clear();
  options.height_map.resolution_m = 0.5;
  const auto tiny = MakeWorldSpec(options);
  REQUIRE(!tiny);
  CHECK_THAT(tiny.error().text, Catch::Contains("too small for a robot with a radius of 2"));
}

TEST_CASE("a map with no way between start and goal is refused", "[height_map]") {
  const Images images;
  cv::Mat image = TwoLakes(CV_8UC1, 90, 200);
  image(cv::Rect(12, 0, 1, 14)).setTo(cv::Scalar(200));
  WorldOptions options;
  options.height_map = {images.Write("a.png", image), 100.0, 1.0};
  options.cell_size_m = 1.0;
  options.starts = {{6, 5}};
  options.goals = {{6, 20}};
  const auto refused = MakeWorldSpec(options);
  REQUIRE(!refused);
  CHECK_THAT(refused.error().text, Catch::Contains("cannot be reached"));
}

}  // namespace
}  // namespace conav::sim
