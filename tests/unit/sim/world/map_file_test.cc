#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>
#include <tuple>

#include "common/runtime/file.h"
#include "sim/world/world_site.h"
#include "support/temporary_folder.h"

namespace conav::sim {
namespace {

namespace fs = std::filesystem;

/// 4 x 5 pixels; 0 black = occupied, 254 white = free, 205 grey = unknown.
constexpr const char* kImage =
    "P2\n# a comment\n5 4\n255\n"
    "254 254 254 254 254\n"
    "254 254   0 254 254\n"
    "254 205 254 254 254\n"
    "254 254 254 254 254\n";

/// A folder with the image.
class Folder : public test::TemporaryFolder {
 public:
  Folder() { Write("map.pgm", kImage); }

  fs::path Write(const std::string& name, const std::string& text) const {
    REQUIRE(WriteFile(*this / name, text));
    return *this / name;
  }
};

constexpr const char* kHeader =
    "image: map.pgm\nresolution: 1.0\norigin: [-1.0, 2.0, 0.0]\nnegate: 0\n"
    "occupied_thresh: 0.65\nfree_thresh: 0.196\n";

std::string Draw(const OccupancyGrid& map) {
  std::string text;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (i > 0 && map.CellAt(i).column == 0) text += "/";
    text += map.values()[i] == Occupancy::kOccupied ? '#' : ' ';
  }
  return text;
}

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

std::string RefusalOf(const Result<OccupancyGrid>& result) {
  return result ? "" : result.error().text;
}

TEST_CASE("a map_server map becomes cells: north first, unknown occupied, border walled", "[map]") {
  const Folder folder;
  CHECK(Draw(*LoadMapFile(folder.Write("map.yaml", kHeader), {.cell_size_m = 1.0})) ==
        "#####/# # #/##  #/#####");
  const std::string negated = Replaced(kHeader, "negate: 0", "negate: 1");
  CHECK(Draw(*LoadMapFile(folder.Write("map.yaml", negated), {.cell_size_m = 1.0})) ==
        "#####/## ##/#####/#####");
  // A last row that the image covers partly is a row.
  const auto coarse = LoadMapFile(folder.Write("map.yaml", kHeader), {.cell_size_m = 1.5});
  REQUIRE(coarse);
  CHECK(coarse->rows() == 3);
  CHECK(coarse->columns() == 4);
}

TEST_CASE("a cell is occupied when more than the share of its pixels is", "[map]") {
  const Folder folder;
  cv::Mat image(12, 12, CV_8UC1, cv::Scalar(255));                   // 3 x 3 cells of 4 x 4 pixels
  for (int i = 0; i < 4; ++i) image.at<std::uint8_t>(4 + i, 5) = 0;  // 4 of 16 in the middle cell
  REQUIRE(cv::imwrite((folder.path() / "map.png").string(), image));
  const std::string header = Replaced(Replaced(kHeader, "map.pgm", "map.png"), "1.0", "0.05");
  const fs::path file = folder.Write("map.yaml", header);
  MapFileOptions options{.cell_size_m = 0.2};
  CHECK(Draw(LoadMapFile(file, options).value()) == "###/# #/###");
  options.occupied_share = 0.24;
  CHECK(Draw(LoadMapFile(file, options).value()) == "###/###/###");
}

TEST_CASE("a map's cells may be smaller than its pixels", "[map]") {
  const Folder folder;
  const auto map = LoadMapFile(folder.Write("map.yaml", kHeader), {.cell_size_m = 0.5});
  REQUIRE(map);
  CHECK(map->rows() == 8);
  CHECK((*map)[{2, 4}] == Occupancy::kOccupied);
  CHECK((*map)[{3, 5}] == Occupancy::kOccupied);
  CHECK((*map)[{2, 3}] == Occupancy::kFree);
}

TEST_CASE("bad map files are refused by file, key and value", "[map]") {
  const Folder folder;
  const std::string name = (folder / "map.yaml").string();
  const std::string wide = "resolution: 1.0";
  for (const auto& [from, to, begins_with] :
       std::vector<std::tuple<std::string, std::string, std::string>>{
           {wide + "\n", "", name + ": key \"resolution\""},
           {wide, "resolution: wide", name + ": resolution = wide"},
           {wide, "resolution: 0", name + ": resolution = 0"},
           {wide, "resolution: .nan", name + ": resolution = .nan"},
           {wide, "resolution: 500", name + ": 4 x 5 pixels of 500 m"},
           {"0.65", "1.5", name + ": occupied_thresh = 1.5"},
           {"0.196", "0.9", name + ": free_thresh 0.9"},
           {"2.0, 0.0]", "2.0]", name + ": origin = [-1.0, 2.0]"},
           {"2.0, 0.0]", "2.0, 1.5]", name + ": origin is turned by 1.5 rad"},
           {"negate", "mode: scale\nnegate", name + ": mode"},
           {kHeader, "just text", name + ": is not a map_server file"},
           {kHeader, "image: [a", name + ": not valid YAML"},
           {"map.pgm", "other.pgm", (folder / "other.pgm").string()},
           {"map.pgm", "map.yaml", name + ": is not an image"},
       }) {
    const auto map =
        LoadMapFile(folder.Write("map.yaml", Replaced(kHeader, from, to)), {.cell_size_m = 1.0});
    CHECK_THAT(RefusalOf(map), Catch::StartsWith(begins_with));
  }
  CHECK_THAT(RefusalOf(LoadMapFile(folder / "none.yaml", {})), Catch::Contains("none.yaml"));
  CHECK_THAT(RefusalOf(LoadMapFile(folder.Write("map.yaml", kHeader), {.cell_size_m = 2.0})),
             Catch::StartsWith(name + ": 4 x 5 pixels"));
}

/// Numbers of four bytes, the most significant first.
std::string Big(std::vector<std::uint32_t> numbers) {
  std::string bytes;
  for (const std::uint32_t number : numbers) {
    for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(number >> shift);
  }
  return bytes;
}

// The faults report's S19: "cv::imread of maps: only cv::Exception is caught, image size not limited
// before decoding."
TEST_CASE("an image that would take too much memory is refused before it is decoded", "[map]") {
  constexpr std::uint32_t kSide = 30'000;
  const Folder folder;
  const std::string little{"\x30\x75\0\0", 4};  // 30 000
  for (const auto& [kind, image] : std::vector<std::pair<std::string, std::string>>{
           {"PNG", "\x89PNG\r\n\x1A\n" + Big({13, 0x49484452, kSide, kSide})},
           {"PGM", "P5 # a comment\n30000 30000\n255\n"},
           {"BMP", "BM" + std::string(16, '\0') + little + little},
           {"BMP, top row first", "BM" + std::string(16, '\0') + little + "\xD0\x8A\xFF\xFF"},
           {"TIFF", std::string("MM\0*", 4) + Big({8}) + std::string("\0\2\1\0\0\4", 6) +
                        Big({1, kSide}) + std::string("\1\1\0\4", 4) + Big({1, kSide})},
           {"TIFF, little", std::string("II*\0\x08\0\0\0\2\0", 10) +
                                std::string("\0\1\4\0\1\0\0\0", 8) + little +
                                std::string("\1\1\4\0\1\0\0\0", 8) + little}}) {
    CAPTURE(kind);
    folder.Write("map.pgm", image);
    const auto map = LoadMapFile(folder.Write("map.yaml", kHeader), {.cell_size_m = 1.0});
    REQUIRE_FALSE(map);
    CHECK_THAT(map.error().text, Catch::Contains("has 900000000 pixels"));
  }
}

// Found by fuzzing: OpenCV gave these to its decoder of DICOM, which aborted.
TEST_CASE("a file that only begins like an image does not end the process", "[map]") {
  const Folder folder;
  for (const std::string begin : {"\x89PNG", "II*4", "P5x"}) {
    CAPTURE(begin);
    std::string image = begin + std::string(128 - begin.size(), '\x0B');
    image += std::string("DICM\0\xFE\x1C", 7);
    folder.Write("map.pgm", image);
    const auto map = LoadMapFile(folder.Write("map.yaml", kHeader), {.cell_size_m = 1.0});
    CHECK_THAT(RefusalOf(map),
               Catch::Contains("is not an image of PNG, PGM (or PPM), BMP or TIFF"));
  }
}

TEST_CASE("a building and its outdated plan must have the same size and origin", "[map]") {
  const Folder folder;
  folder.Write("small.pgm", "P2\n3 3\n255\n254 254 254 254 254 254 254 254 254\n");
  const fs::path truth = folder.Write("truth.yaml", kHeader);
  const fs::path plan = folder.Write("plan.yaml", Replaced(kHeader, "map.pgm", "small.pgm"));
  const fs::path moved = folder.Write("moved.yaml", Replaced(kHeader, "-1.0, 2.0", "-1.0, 3.0"));
  CHECK(LoadMapPair(truth, truth, {.cell_size_m = 1.0}));
  for (const auto& [other, differs] :
       {std::pair(plan, "3 x 3 cells"), std::pair(moved, "origin at (-1, 3)")}) {
    const auto pair = LoadMapPair(truth, other, {.cell_size_m = 1.0});
    REQUIRE_FALSE(pair);
    CHECK_THAT(pair.error().text, Catch::StartsWith(other.string()) && Catch::Contains(differs) &&
                                      Catch::Contains(truth.string()));
  }
}

}  // namespace
}  // namespace conav::sim
