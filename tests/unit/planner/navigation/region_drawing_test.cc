#include "planner/navigation/region_drawing.h"

#include <catch2/catch.hpp>
#include <string>

#include "planner/navigation/region_graph.h"
#include "support/text.h"
#include "support/xml_check.h"
#include "unit/planner/search/text_map.h"

namespace conav::planner {

TEST_CASE("A drawing shows each vertex and edge once, and all cells of regions",
          "[planner][navigation]") {
  OccupancyGrid map(40, 60, Occupancy::kFree);
  map[{20, 30}] = Occupancy::kUnknown;
  RegionGraph graph({}, std::make_shared<const GridViews>(kNoViews));
  graph.Update(map);
  SvgCanvas canvas;
  DrawRegions(graph, {0, 0}, 4.0, canvas);
  const std::string drawn = canvas.Inline(240, 160, "Graph");
  CHECK(test::XmlError(drawn).empty());
  CHECK(test::CountOf(drawn, "<circle") == graph.vertex_count());
  CHECK(test::CountOf(drawn, "<line") == graph.uncertainty_count());
  CHECK(test::CountOf(drawn, "stroke-dasharray") > 0);
  CHECK(test::CountOf(drawn, "<rect") >= 40);  // a run of cells each
}

}  // namespace conav::planner
