#include <catch2/catch.hpp>

#include "planner/search/search_problem.h"
#include "unit/planner/search/text_map.h"

namespace conav::planner {
namespace {

std::vector<Cell> TargetsFrom(const GridGraph& graph, Cell from) {
  std::vector<Cell> targets;
  for (const Edge& edge : graph.EdgesFrom(graph.VertexAt(from).value())) {
    targets.push_back(graph.CellOf(edge.target));
  }
  return targets;
}

TEST_CASE("moves lead north, east, south, west, and not into known walls", "[planner][search]") {
  const GridGraph graph(MapFrom({"#####", "#...#", "#...#", "#.#.#", "#####"}), {});
  CHECK(TargetsFrom(graph, {2, 2}) == std::vector<Cell>{{1, 2}, {2, 3}, {2, 1}});
  CHECK(TargetsFrom(graph, {3, 1}) == std::vector<Cell>{{2, 1}});
}

TEST_CASE("an unknown cell is entered with probability one half", "[planner][search]") {
  const GridGraph graph(MapFrom({"#####", "#.?.#", "#####"}), {});
  const auto edges = graph.EdgesFrom(graph.VertexAt({1, 1}).value());
  REQUIRE(edges.size() == 1);
  CHECK(edges[0].feasibility == 0.5);
  CHECK(edges[0].uncertainty == graph.VertexAt({1, 2}).value());
  CHECK(graph.EdgesFrom(graph.VertexAt({1, 2}).value())[0].feasibility == 1.0);
}

TEST_CASE("cells that others occupy now cannot be entered, but left", "[planner][search]") {
  const std::vector<Cell> occupied{{1, 2}, {-3, 7}};
  const GridGraph graph(MapFrom({"#####", "#...#", "#####"}), occupied);
  CHECK(TargetsFrom(graph, {1, 1}).empty());
  CHECK(TargetsFrom(graph, {1, 2}) == std::vector<Cell>{{1, 3}, {1, 1}});
}

TEST_CASE("walls, cells outside and the border, before it was seen, are no vertices",
          "[planner][search]") {
  const GridGraph unseen(MapFrom({"???", "?.?", "???"}), {});
  CHECK(unseen.EdgesFrom(4).empty());
  CHECK_FALSE(unseen.VertexAt({0, 1}).has_value());
  const GridGraph graph(MapFrom({"###", "#.#", "###"}), {});
  CHECK_FALSE(graph.VertexAt({0, 0}).has_value());
  CHECK_FALSE(graph.VertexAt({3, 0}).has_value());
  CHECK_FALSE(graph.VertexAt({0, -1}).has_value());
  CHECK(graph.CellOf(graph.VertexAt({1, 1}).value()) == Cell{1, 1});
}

std::size_t Differing(const std::vector<Cell>& a, const std::vector<Cell>& b) {
  std::vector<Cell> difference;
  std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(),
                                std::back_inserter(difference));
  return difference.size();
}

TEST_CASE("a view shows what the robot's picture would show", "[planner][search]") {
  const OccupancyGrid map =
      MapFrom({"#############", "#.....#.....#", "#.###.#.###.#", "#.#...#...#.#", "#.#.#####.#.#",
               "#...#...#...#", "###.#.#.#.###", "#...#.#.#...#", "#.###.#.###.#", "#.....#.....#",
               "#.#########.#", "#...........#", "#############"});
  const int width = GENERATE(320, 640, 200);
  GridViews::Options options;
  options.lens = CameraLens{width, 192, HorizontalFov(width, 192)};
  options.cell_size_m = GENERATE(2.0, 1.0);
  const GridGraph graph(map, {}, std::make_shared<const GridViews>(options));
  std::size_t cells = 0;
  std::size_t differing = 0;
  for (VertexId vertex = 0; vertex < graph.vertex_count(); ++vertex) {
    if (map.values()[static_cast<std::size_t>(vertex)] != Occupancy::kFree) continue;
    for (int i = 0; i < 8; ++i) {
      const Cell cell = graph.CellOf(vertex);
      const double heading = graph.HeadingsAt(vertex)[static_cast<std::size_t>(i)];
      const VisibleCells snapshot =
          CastView(map, ViewAt(cell, heading, options.cell_size_m, width, 192));
      const VisibleCells& view = graph.ViewFrom(vertex, i);
      cells += snapshot.free.size() + snapshot.walls.size();
      differing += Differing(snapshot.free, view.free) + Differing(snapshot.walls, view.walls);
    }
  }
  INFO(differing << " of " << cells << " cells");
  // Slivers between two rays.
  CHECK(differing * 50 < cells);
}

TEST_CASE("a view is what CastView shows on the known map", "[planner][search]") {
  const OccupancyGrid map = MapFrom({"######", "#...?#", "#.##.#", "######"});
  const GridGraph graph(map, {});
  const VertexId vertex = graph.VertexAt({1, 1}).value();
  REQUIRE(graph.HeadingsAt(vertex).size() == 8);
  CHECK(graph.HeadingsAt(vertex)[0] == 0.0);
  const VisibleCells& east = graph.ViewFrom(vertex, 0);
  CHECK(east == CastView(map, ViewAt({1, 1}, 0.0, 2.0, 320, 192)));
  CHECK(std::find(east.free.begin(), east.free.end(), Cell{1, 3}) != east.free.end());
  CHECK(std::find(east.free.begin(), east.free.end(), Cell{1, 4}) == east.free.end());
  CHECK(&east == &graph.ViewFrom(vertex, 0));
}

}  // namespace
}  // namespace conav::planner
