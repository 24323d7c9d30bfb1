#include "common/plot/map_panel.h"

#include <catch2/catch.hpp>

namespace conav {
namespace {

constexpr CellStyles kStyles{
    .wall = "class=\"w\"", .free = "class=\"f\"", .unknown = "class=\"u\""};

std::string Document(const SvgCanvas& canvas) { return canvas.Inline(100.0, 100.0, "t"); }

TEST_CASE("cells lie row by row from the panel's corner", "[svg]") {
  SvgCanvas canvas;
  const MapPanel panel(canvas, {10.0, 20.0}, 8.0);
  CHECK(panel.Corner({1, 2}).x == 26.0);
  CHECK(panel.Corner({1, 2}).y == 28.0);
  CHECK(panel.Middle({0, 0}).x == 14.0);
  CHECK(panel.Middle({0, 0}).y == 24.0);
}

TEST_CASE("an occupancy map shows walls, free and unknown cells, a belief walls from one half on",
          "[svg]") {
  SvgCanvas canvas;
  OccupancyGrid map(1, 3, Occupancy::kUnknown);
  map[{0, 0}] = Occupancy::kOccupied;
  map[{0, 1}] = Occupancy::kFree;
  MapPanel(canvas, {}, 10.0).DrawMap(map, kStyles);
  CHECK_THAT(
      Document(canvas),
      Catch::Contains("<rect x=\"0.0\" y=\"0.0\" width=\"9.0\" height=\"9.0\" class=\"w\"/>\n"
                      "<rect x=\"10.0\" y=\"0.0\" width=\"9.0\" height=\"9.0\" class=\"f\"/>\n"
                      "<rect x=\"20.0\" y=\"0.0\" width=\"9.0\" height=\"9.0\" class=\"u\"/>"));
  SvgCanvas believed;
  BeliefGrid belief(1, 2, 0.5F);
  belief[{0, 1}] = 0.49F;
  MapPanel(believed, {}, 10.0).DrawMap(belief, kStyles);
  CHECK_THAT(
      Document(believed),
      Catch::Contains("<rect x=\"0.0\" y=\"0.0\" width=\"9.0\" height=\"9.0\" class=\"w\"/>") &&
          Catch::Contains("height=\"9.0\" class=\"f\"/>"));
}

TEST_CASE("an arrow to the north points up, by its length in cells, a path runs through middles",
          "[svg]") {
  SvgCanvas canvas;
  MapPanel(canvas, {}, 10.0)
      .DrawArrow({50.0, 50.0}, 1.5707963267948966, {.length = 1.0, .half_width = 0.2},
                 "class=\"s\"");
  CHECK_THAT(Document(canvas),
             Catch::Contains("<polygon points=\"50.0,40.0 52.0,50.0 48.0,50.0\" class=\"s\"/>"));
  const Cell cells[] = {{0, 0}, {0, 1}};
  MapPanel(canvas, {}, 10.0).DrawPath(cells, "class=\"s\"", 2.0);
  CHECK_THAT(Document(canvas), Catch::Contains("<polyline points=\"7.0,7.0 17.0,7.0\""));
}

}  // namespace
}  // namespace conav
