#include "nhpm/model/canvas_placement.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <numbers>
#include <set>

#include "conformance/perception_model_conformance.h"

namespace conav::nhpm {
namespace {

constexpr double kPi = std::numbers::pi;

TEST_CASE("A map that is scaled by 2 covers 2 x 2 pixels a cell", "[canvas]") {
  const Placement placement{.canvas = 6, .scale = 2.0, .centre_row = 3.0, .centre_column = 3.0};
  const CanvasMap map(placement, 2, 3);
  const std::vector<std::int32_t> expected{-1, -1, -1, -1, -1, -1, 0,  0,  1,  1,  2,  2,
                                           0,  0,  1,  1,  2,  2,  3,  3,  4,  4,  5,  5,
                                           3,  3,  4,  4,  5,  5,  -1, -1, -1, -1, -1, -1};
  CHECK(std::ranges::equal(map.sources(), expected));
  CHECK(map.PixelOf({0, 2}) == Cell{2, 5});
}

TEST_CASE("Turning and mirroring move cells and headings alike", "[canvas]") {
  struct Row {
    double angle_rad;
    bool mirrored;
    std::vector<std::int32_t> sources;  // of a 2 x 2 map at scale 1
    double east_becomes;
  };
  const auto row = GENERATE(values<Row>({{0.0, false, {0, 1, 2, 3}, 0.0},
                                         {kPi / 2, false, {1, 3, 0, 2}, kPi / 2},
                                         {kPi, false, {3, 2, 1, 0}, kPi},
                                         {0.0, true, {1, 0, 3, 2}, kPi},
                                         {kPi / 2, true, {0, 2, 1, 3}, 3 * kPi / 2}}));
  const Placement placement{2, 1.0, row.angle_rad, row.mirrored, 1.0, 1.0};
  const CanvasMap map(placement, 2, 2);
  CAPTURE(row.angle_rad, row.mirrored);
  CHECK(std::ranges::equal(map.sources(), row.sources));
  CHECK(map.HeadingOf(0.0) == Approx(row.east_becomes));
}

TEST_CASE(
    "Drawn placements have the paper's sizes, keep the camera and count scale^2 pixels a cell",
    "[canvas]") {
  std::set<double> sides;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const Cell camera{static_cast<int>(seed % 13), 12};
    const Placement placement = DrawPlacement(kPaperCanvas, 13, 13, camera, random);
    const double side = 13.0 * placement.scale;
    sides.insert(side);
    REQUIRE(side >= 100.0 - 1e-9);
    REQUIRE(side <= 150.0 + 1e-9);
    const CanvasMap map(placement, 13, 13);
    const Cell pixel = map.PixelOf(camera);
    const auto index = static_cast<std::size_t>(pixel.row * kPaperCanvas + pixel.column);
    CHECK(map.sources()[index] == camera.row * 13 + camera.column);
    const auto pixels = std::ranges::count(map.sources(), 6 * 13 + 6);  // the middle
    CHECK(static_cast<double>(pixels) == Approx(placement.scale * placement.scale).epsilon(0.15));
  }
  CHECK(sides.size() > 20);
}

TEST_CASE("Equal seeds give equal placements, and small canvases work", "[canvas]") {
  for (const int canvas : {1, 2, 20, 150}) {
    Random one(canvas);
    Random two(canvas);
    const Placement a = DrawPlacement(canvas, 5, 7, {2, 3}, one);
    const Placement b = DrawPlacement(canvas, 5, 7, {2, 3}, two);
    CAPTURE(canvas);
    CHECK(a.scale == b.scale);
    CHECK(a.angle_rad == b.angle_rad);
    CHECK(a.centre_row == b.centre_row);
  }
}

TEST_CASE("A pasted query can be answered, with walls around the map", "[canvas]") {
  const PerceptionQuery query = planner::conformance::MakeQuery(3);
  Random random(4);
  const CanvasMap map(DrawPlacement(60, 9, 11, query.cell, random), 9, 11);
  const PerceptionQuery pasted = map.Paste(query);
  REQUIRE(CheckPerceptionQuery(pasted));
  const Grid<std::uint8_t> seen(60, 60);
  std::size_t outside = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const std::int32_t source = map.sources()[i];
    const float expected =
        source < 0 ? 1.0F : query.belief.values()[static_cast<std::size_t>(source)];
    REQUIRE(pasted.belief.values()[i] == expected);
    outside += source < 0 ? 1 : 0;
  }
  CHECK(outside > 0);
  CHECK(pasted.visible.free.size() > query.visible.free.size());
  CHECK(std::ranges::count(pasted.path, pasted.cell) == 1);
}

}  // namespace
}  // namespace conav::nhpm
