#include "sim/world/map_file.h"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

namespace conav::sim {
namespace {

namespace fs = std::filesystem;

/// A folder of this test, gone at its end.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("conav_map_file_" + std::to_string(getpid()))) {
    fs::create_directories(path_);
  }
  ~Folder() { fs::remove_all(path_); }

  fs::path Write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name) << text;
    return path_ / name;
  }
  fs::path path() const { return path_; }

 private:
  fs::path path_;
};

constexpr const char* kHeader =
    "image: map.pgm\nresolution: 1.0\norigin: [-1.0, 2.0, 0.0]\nnegate: 0\n"
    "occupied_thresh: 0.65\nfree_thresh: 0.196\n";

/// 4 x 5 pixels; 0 black = occupied, 254 white = free, 205 grey = unknown.
constexpr const char* kImage =
    "P2\n# a comment\n5 4\n255\n"
    "254 254 254 254 254\n"
    "254 254   0 254 254\n"
    "254 205 254 254 254\n"
    "254 254 254 254 254\n";

std::string Draw(const OccupancyGrid& map) {
  std::string text;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (i > 0 && map.CellAt(i).column == 0) text += "/";
    text += map.values()[i] == Occupancy::kOccupied ? '#' : ' ';
  }
  return text;
}

MapFileOptions CellsOf(double cell_size_m) {
  MapFileOptions options;
  options.cell_size_m = cell_size_m;
  return options;
}

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

std::string RefusalOf(const Result<OccupancyGrid>& result) {
  return result ? "" : result.error().text;
}

TEST_CASE("a map_server map becomes cells: north first, unknown occupied, border walled",
          "[sim][map]") {
  const Folder folder;
  folder.Write("map.pgm", kImage);
  const auto map = LoadMapFile(folder.Write("map.yaml", kHeader), CellsOf(1.0));
  REQUIRE(map);
  CHECK(Draw(*map) == "#####/# # #/##  #/#####");
}

TEST_CASE("negate turns light and dark", "[sim][map]") {
  const Folder folder;
  folder.Write("map.pgm", kImage);
  const std::string header = Replaced(kHeader, "negate: 0", "negate: 1");
  const auto map = LoadMapFile(folder.Write("map.yaml", header), CellsOf(1.0));
  REQUIRE(map);
  CHECK(Draw(*map) == "#####/## ##/#####/#####");
}

TEST_CASE("a cell is occupied when more than the share of its pixels is", "[sim][map]") {
  const Folder folder;
  cv::Mat image(12, 12, CV_8UC1, cv::Scalar(255));                   // 3 x 3 cells of 4 x 4 pixels
  for (int i = 0; i < 4; ++i) image.at<std::uint8_t>(4 + i, 5) = 0;  // 4 of 16 in the middle cell
  REQUIRE(cv::imwrite((folder.path() / "map.png").string(), image));
  const std::string header = Replaced(Replaced(kHeader, "map.pgm", "map.png"), "1.0", "0.05");
  const fs::path file = folder.Write("map.yaml", header);
  MapFileOptions options = CellsOf(0.2);
  CHECK(Draw(LoadMapFile(file, options).value()) == "###/# #/###");
  options.occupied_share = 0.24;
  CHECK(Draw(LoadMapFile(file, options).value()) == "###/###/###");
}

TEST_CASE("a last row that the image covers partly is a row", "[sim][map]") {
  const Folder folder;
  folder.Write("map.pgm", kImage);
  const auto map = LoadMapFile(folder.Write("map.yaml", kHeader), CellsOf(1.5));
  REQUIRE(map);
  CHECK(map->rows() == 3);
  CHECK(map->columns() == 4);
}

TEST_CASE("a binary PGM reads like a plain one", "[sim][map]") {
  const Folder folder;
  std::string binary = "P5\n3 3\n255\n";
  binary += std::string(4, '\xfe') + std::string(1, '\xfe') + std::string(4, '\0');
  folder.Write("map.pgm", binary);
  const auto map = LoadMapFile(folder.Write("map.yaml", kHeader), CellsOf(1.0));
  REQUIRE(map);
  CHECK(Draw(*map) == "###/# #/###");
}

TEST_CASE("bad map files are refused by file, key and value", "[sim][map]") {
  const Folder folder;
  folder.Write("map.pgm", kImage);
  const std::string name = (folder.path() / "map.yaml").string();
  const auto refusal_of = [&](const std::string& header) {
    return RefusalOf(LoadMapFile(folder.Write("map.yaml", header), CellsOf(1.0)));
  };
  CHECK(refusal_of(Replaced(kHeader, "resolution: 1.0\n", "")) ==
        name + ": key \"resolution\" is missing");
  CHECK(refusal_of(Replaced(kHeader, "resolution: 1.0", "resolution: wide")) ==
        name + ": resolution = wide is not a number");
  CHECK(refusal_of(Replaced(kHeader, "resolution: 1.0", "resolution: 0")) ==
        name + ": resolution = 0 is not in [0.0001, 1000]");
  CHECK(refusal_of(Replaced(kHeader, "resolution: 1.0", "resolution: .nan")) ==
        name + ": resolution = .nan is not in [0.0001, 1000]");
  CHECK(refusal_of(Replaced(kHeader, "resolution: 1.0", "resolution: 2.0")) ==
        name + ": cell_size_m 1 is smaller than the map's resolution 2");
  CHECK(refusal_of(Replaced(kHeader, "0.65", "1.5")) ==
        name + ": occupied_thresh = 1.5 is not in [0, 1]");
  CHECK(refusal_of(Replaced(kHeader, "0.196", "0.9")) ==
        name + ": free_thresh 0.9 is larger than occupied_thresh 0.65");
  CHECK(refusal_of(Replaced(kHeader, "2.0, 0.0]", "2.0]")) ==
        name + ": origin = [-1.0, 2.0] is not three numbers [x, y, yaw]");
  CHECK(refusal_of(Replaced(kHeader, "2.0, 0.0]", "2.0, 1.5]")) ==
        name + ": origin is turned by 1.5 rad: only 0 is understood");
  CHECK(refusal_of(std::string(kHeader) + "mode: scale\n") ==
        name + ": mode is not \"trinary\", the one that is understood");
  CHECK(refusal_of("just text") == name + ": is no map_server file: no keys");
  CHECK_THAT(refusal_of("image: [a"), Catch::StartsWith(name + ": not valid YAML"));
  CHECK(refusal_of(Replaced(kHeader, "map.pgm", "other.pgm")) ==
        (folder.path() / "other.pgm").string() + ": no such image");
  CHECK(refusal_of(Replaced(kHeader, "map.pgm", "map.yaml")) == name + ": is no image");
  CHECK(RefusalOf(LoadMapFile(folder.path() / "none.yaml", {})) ==
        (folder.path() / "none.yaml").string() + ": no such file");
}

TEST_CASE("a map of too few cells is refused", "[sim][map]") {
  const Folder folder;
  folder.Write("map.pgm", kImage);
  const fs::path file = folder.Write("map.yaml", kHeader);
  CHECK(RefusalOf(LoadMapFile(file, CellsOf(2.0))) ==
        file.string() + ": 4 x 5 pixels of 1 m make 2 x 3 cells of 2 m: not in [3, 501]");
}

TEST_CASE("a building and its outdated plan must have the same size and origin", "[sim][map]") {
  const Folder folder;
  folder.Write("map.pgm", kImage);
  folder.Write("small.pgm", "P2\n3 3\n255\n254 254 254 254 254 254 254 254 254\n");
  const fs::path truth = folder.Write("truth.yaml", kHeader);
  const fs::path plan = folder.Write("plan.yaml", Replaced(kHeader, "map.pgm", "small.pgm"));
  const fs::path moved = folder.Write("moved.yaml", Replaced(kHeader, "-1.0, 2.0", "-1.0, 3.0"));
  CHECK(LoadMapPair(truth, truth, CellsOf(1.0)));
  const auto other_size = LoadMapPair(truth, plan, CellsOf(1.0));
  REQUIRE_FALSE(other_size);
  CHECK(other_size.error().text ==
        plan.string() + " has 3 x 3 cells, " + truth.string() + " has 4 x 5: must be the same");
  const auto other_origin = LoadMapPair(truth, moved, CellsOf(1.0));
  REQUIRE_FALSE(other_origin);
  CHECK(other_origin.error().text == moved.string() + " has its origin at (-1, 3), " +
                                         truth.string() + " at (-1, 2): must be the same");
}

}  // namespace
}  // namespace conav::sim
