#include "planner/navigation/region_graph.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <set>

#include "planner/search/parallel_search.h"
#include "planner/search/path_state.h"
#include "support/steps_to_goals.h"
#include "unit/planner/navigation/raster_worlds.h"
#include "unit/planner/search/text_map.h"

namespace conav::planner {
namespace {

std::shared_ptr<const GridViews> Views(const GridViews::Options& options = kNoViews) {
  return std::make_shared<const GridViews>(options);
}

struct BuiltGraph {
  explicit BuiltGraph(const OccupancyGrid& known, const RegionOptions& options = {},
                      const GridViews::Options& views = kNoViews)
      : graph(options, Views(views)) {
    graph.Update(known);
  }
  RegionGraph graph;
};

/// By cell: the smallest index that 4-connected steps reach, -1 where nobody can be.
std::vector<int> PiecesOf(const RegionPartition& partition) {
  std::vector<int> pieces(partition.known().size(), -1);
  for (std::size_t first = 0; first < pieces.size(); ++first) {
    if (pieces[first] >= 0 || !partition.IsTraversable(partition.known().CellAt(first))) continue;
    std::vector<int> open{static_cast<int>(first)};
    pieces[first] = open.front();
    while (!open.empty()) {
      const int index = open.back();
      open.pop_back();
      partition.ForNeighbours(index, [&](int next) {
        const auto at = static_cast<std::size_t>(next);
        if (pieces[at] >= 0 || !partition.IsTraversable(partition.known().CellAt(at))) return;
        pieces[at] = static_cast<int>(first);
        open.push_back(next);
      });
    }
  }
  return pieces;
}

/// By vertex: the smallest vertex that edges reach.
std::vector<int> ComponentsOf(const NavigationGraph& graph) {
  std::vector<int> components(static_cast<std::size_t>(graph.vertex_count()), -1);
  for (VertexId first = 0; first < graph.vertex_count(); ++first) {
    if (components[static_cast<std::size_t>(first)] >= 0) continue;
    components[static_cast<std::size_t>(first)] = first;
    std::vector<VertexId> open{first};
    while (!open.empty()) {
      const VertexId vertex = open.back();
      open.pop_back();
      for (const Edge& edge : graph.EdgesFrom(vertex)) {
        int& component = components[static_cast<std::size_t>(edge.target)];
        if (component >= 0) continue;
        component = first;
        open.push_back(edge.target);
      }
    }
  }
  return components;
}

/// The graph connects two cells exactly if steps from cell to cell do.
void CheckConnectsWhatCellsConnect(const OccupancyGrid& known, const RegionOptions& options) {
  const BuiltGraph built(known, options);
  RegionPartition partition(options);
  partition.Update(known);
  const std::vector<int> pieces = PiecesOf(partition);
  const std::vector<int> components = ComponentsOf(built.graph);
  std::set<std::pair<int, int>> pairs;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const auto vertex = built.graph.VertexAt(known.CellAt(i));
    REQUIRE(vertex.has_value() == (pieces[i] >= 0));
    if (vertex) pairs.emplace(pieces[i], components[static_cast<std::size_t>(*vertex)]);
  }
  std::set<int> with_cells;
  std::set<int> with_vertices;
  for (const auto& [piece, component] : pairs) {
    with_cells.insert(piece);
    with_vertices.insert(component);
  }
  CHECK(pairs.size() == with_cells.size());     // nothing is cut in two
  CHECK(pairs.size() == with_vertices.size());  // nothing leaks through a wall
}

/// Cells that a line touches, by sampling it; those that it hardly touches may be missing.
std::set<Cell> SampledLine(Cell from, Cell to) {
  std::set<Cell> cells;
  for (int i = 0; i <= 2000; ++i) {
    const double row = from.row + 0.5 + (to.row - from.row) * i / 2000.0;
    const double column = from.column + 0.5 + (to.column - from.column) * i / 2000.0;
    cells.insert({static_cast<int>(std::floor(row)), static_cast<int>(std::floor(column))});
  }
  return cells;
}

void RequireEqual(const RegionGraph& a, const RegionGraph& b) {
  REQUIRE(a.vertex_count() == b.vertex_count());
  REQUIRE(a.uncertainty_count() == b.uncertainty_count());
  for (VertexId vertex = 0; vertex < a.vertex_count(); ++vertex) {
    REQUIRE(a.CellOf(vertex) == b.CellOf(vertex));
    REQUIRE(std::ranges::equal(a.CellsOf(vertex), b.CellsOf(vertex)));
    REQUIRE(std::ranges::equal(a.EdgesFrom(vertex), b.EdgesFrom(vertex)));
  }
  for (std::size_t i = 0; i < a.known().size(); ++i) {
    REQUIRE(a.VertexAt(a.known().CellAt(i)) == b.VertexAt(a.known().CellAt(i)));
  }
}

}  // namespace

TEST_CASE("A region's vertex is its cell nearest to the centroid", "[planner][navigation]") {
  const BuiltGraph built(MapFrom({"########",  //
                                  "#    ###",  //
                                  "# ######",  //
                                  "# ######",  //
                                  "########"}));
  REQUIRE(built.graph.vertex_count() == 1);
  CHECK(built.graph.CellOf(0) == Cell{1, 2});  // of the centroid (1.5, 1.8)
  CHECK(built.graph.CellsOf(0).size() == 6);
  CHECK(built.graph.EdgesFrom(0).empty());
  CHECK(built.graph.VertexAt({3, 1}) == 0);
  CHECK_FALSE(built.graph.VertexAt({0, 0}).has_value());
}

TEST_CASE("An unseen world is a graph, one without a traversable cell is empty",
          "[planner][navigation]") {
  RegionGraph graph({}, Views());
  CHECK(graph.vertex_count() == 0);
  CHECK_FALSE(graph.VertexAt({0, 0}).has_value());
  graph.Update(OccupancyGrid(60, 60, Occupancy::kUnknown));
  CHECK(graph.vertex_count() > 20);
  for (VertexId vertex = 0; vertex < graph.vertex_count(); ++vertex) {
    for (const Edge& edge : graph.EdgesFrom(vertex)) CHECK(edge.feasibility == 0.5);
  }
  graph.Update(OccupancyGrid(60, 60, Occupancy::kFree));
  for (VertexId vertex = 0; vertex < graph.vertex_count(); ++vertex) {
    for (const Edge& edge : graph.EdgesFrom(vertex)) CHECK(edge.feasibility == 1.0);
  }
  graph.Update(OccupancyGrid(60, 50, Occupancy::kOccupied));
  CHECK(graph.vertex_count() == 0);
  graph.Update(OccupancyGrid(0, 0));
  CHECK(graph.vertex_count() == 0);
}

TEST_CASE("Vertices share out the traversable cells", "[planner][navigation]") {
  Random random(2);
  const OccupancyGrid map = Waterway(100, 14, random);
  const BuiltGraph built(map);
  std::size_t cells = 0;
  for (VertexId vertex = 0; vertex < built.graph.vertex_count(); ++vertex) {
    const auto own = built.graph.CellsOf(vertex);
    cells += own.size();
    CHECK(std::ranges::is_sorted(own));
    CHECK(std::ranges::count(own, built.graph.CellOf(vertex)) == 1);
    for (const Cell cell : own) REQUIRE(built.graph.VertexAt(cell) == vertex);
  }
  CHECK(cells == static_cast<std::size_t>(std::ranges::count(map.values(), Occupancy::kFree)));
}

TEST_CASE("An edge is a straight line that stays traversable, the same both ways",
          "[planner][navigation]") {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Random random(seed);
    Exploration exploration(Waterway(90, 14, random), 25, seed);
    for (int i = 0; i < 20; ++i) exploration.Go(10);
    const OccupancyGrid& known = exploration.known();
    const BuiltGraph built(known, {.step_length_cells = 8.0});
    const RegionGraph& graph = built.graph;
    std::vector<int> directions(static_cast<std::size_t>(graph.uncertainty_count()));
    for (VertexId vertex = 0; vertex < graph.vertex_count(); ++vertex) {
      for (const Edge& edge : graph.EdgesFrom(vertex)) {
        ++directions[static_cast<std::size_t>(edge.uncertainty)];
        Edge back = edge;
        back.target = vertex;
        CHECK(std::ranges::count(graph.EdgesFrom(edge.target), back) == 1);
        const Cell way = graph.CellOf(edge.target) - graph.CellOf(vertex);
        CHECK(edge.length == Approx(std::hypot(way.row, way.column) / 8.0));
        bool is_seen = true;
        for (const Cell cell : SampledLine(graph.CellOf(vertex), graph.CellOf(edge.target))) {
          REQUIRE(graph.VertexAt(cell).has_value());
          is_seen = is_seen && known[cell] == Occupancy::kFree;
        }
        if (!is_seen) CHECK(edge.feasibility == RegionGraph::kUnseenFeasibility);
      }
    }
    CHECK(std::ranges::all_of(directions, [](int count) { return count == 2; }));
  }
}

TEST_CASE("Cells that touch at a corner alone are not connected", "[planner][navigation]") {
  const BuiltGraph built(MapFrom({"######",  //
                                  "#  ###",  //
                                  "#  ###",  //
                                  "###  #",  //
                                  "###  #",  //
                                  "######"}));
  REQUIRE(built.graph.vertex_count() == 2);
  CHECK(built.graph.EdgesFrom(0).empty());
}

TEST_CASE("The graph connects what the cells connect", "[planner][navigation]") {
  Random random(11);
  std::vector<OccupancyGrid> maps;
  for (int i = 0; i < 6; ++i) {
    maps.push_back(Waterway(110, 12 + 2 * i, random));
    maps.push_back(Speckles(80, 0.1 * i, random));
    maps.push_back(ScaledMaze(14, 1 + i, random));
    maps.push_back(Spiral(90, 1 + i));
    maps.push_back(DiagonalCorridor(70, i));
  }
  for (const OccupancyGrid& map : maps) {
    for (const RegionOptions& options :
         {RegionOptions{}, RegionOptions{.cells_per_seed = 25},
          RegionOptions{.cells_per_seed = 400}, RegionOptions{.clearance_cells = 1.5}}) {
      CheckConnectsWhatCellsConnect(map, options);
    }
  }
}

TEST_CASE("A passage through a wall is kept however narrow", "[planner][navigation]") {
  for (const int width : {1, 2}) {
    for (int gap = 1; gap + width < 58; gap += 3) {
      const OccupancyGrid map = RasterOf(60, 60, [&](Cell cell) {
        const bool in_wall = cell.column >= 27 && cell.column <= 31;
        return in_wall && (cell.row < gap || cell.row >= gap + width);
      });
      const BuiltGraph built(map);
      const std::vector<int> components = ComponentsOf(built.graph);
      CHECK(std::ranges::count(components, 0) == built.graph.vertex_count());
    }
  }
}

TEST_CASE("An update equals a new graph after random changes", "[planner][navigation]") {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Random random(seed);
    const int side = static_cast<int>(random.Uniform(20, 60));
    OccupancyGrid map = seed % 3 == 0   ? Speckles(side, 0.35, random)
                        : seed % 3 == 1 ? Waterway(side, 9, random)
                                        : OccupancyGrid(side, side, Occupancy::kUnknown);
    const RegionOptions options{.cells_per_seed = seed % 4 == 0 ? 90.0 : 25.0,
                                .clearance_cells = static_cast<double>(seed % 5)};
    BuiltGraph built(map, options);
    for (int update = 0; update < 6; ++update) {
      const auto changes = random.Uniform(0, seed % 2 == 0 ? 3 : 40);
      for (int i = 0; i < changes; ++i) {
        const Cell cell{static_cast<int>(random.Uniform(0, side - 1)),
                        static_cast<int>(random.Uniform(0, side - 1))};
        map[cell] = static_cast<Occupancy>(random.Uniform(0, 2));
      }
      built.graph.Update(map);
      RequireEqual(built.graph, BuiltGraph(map, options).graph);
    }
  }
}

TEST_CASE("An update equals a new graph while a robot explores", "[planner][navigation]") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Random random(seed);
    Exploration exploration(seed % 2 == 0 ? Waterway(120, 20, random) : ScaledMaze(20, 5, random),
                            30, seed);
    const RegionOptions options{.clearance_cells = seed % 3 == 0 ? 2.0 : 0.0};
    BuiltGraph built(exploration.known(), options);
    for (int update = 0; update < 20; ++update) {
      built.graph.Update(exploration.Go(15));
      RequireEqual(built.graph, BuiltGraph(exploration.known(), options).graph);
    }
  }
}

TEST_CASE("A map of another size starts from nothing", "[planner][navigation]") {
  Random random(1);
  const OccupancyGrid small = Waterway(50, 10, random);
  const OccupancyGrid large = Waterway(80, 10, random);
  BuiltGraph built(small);
  built.graph.Update(large);
  RequireEqual(built.graph, BuiltGraph(large).graph);
}

TEST_CASE("A vertex offers few enough moves for the search", "[planner][navigation]") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    for (const OccupancyGrid& map : {Speckles(120, 0.35, random), ScaledMaze(40, 1, random)}) {
      const BuiltGraph built(map);
      for (VertexId vertex = 0; vertex < built.graph.vertex_count(); ++vertex) {
        REQUIRE(built.graph.EdgesFrom(vertex).size() <= 40);
      }
    }
  }
}

TEST_CASE("A view starts at the vertex and ends at its range", "[planner][navigation]") {
  const GridViews::Options east{.headings = 1, .lens = {}, .range_cells = 12.0};
  const BuiltGraph built(OccupancyGrid(60, 60, Occupancy::kFree), {}, east);
  REQUIRE(built.graph.HeadingsAt(0).size() == 1);
  const VertexId vertex = built.graph.VertexAt({30, 20}).value();
  const Cell from = built.graph.CellOf(vertex);
  const VisibleCells& view = built.graph.ViewFrom(vertex, 0);
  CHECK(&view == &built.graph.ViewFrom(vertex, 0));
  CHECK(Contains(view.free, from + Cell{0, 12}));
  CHECK_FALSE(Contains(view.free, from + Cell{0, 14}));
  for (const Cell cell : view.free) {
    CHECK(std::hypot(cell.row - from.row, cell.column - from.column) < 14.0);
  }
}

TEST_CASE("A view shows the newest map", "[planner][navigation]") {
  OccupancyGrid map(40, 40, Occupancy::kFree);
  BuiltGraph built(map, {}, {.headings = 1, .lens = {}});
  const Cell from = built.graph.CellOf(built.graph.VertexAt({20, 10}).value());
  const Cell wall{from.row, 35};
  const auto view = [&] {
    return built.graph.ViewFrom(built.graph.VertexAt(from).value(), 0).walls;
  };
  CHECK_FALSE(Contains(view(), wall));
  map[wall] = Occupancy::kOccupied;
  built.graph.Update(map);
  REQUIRE(built.graph.CellOf(built.graph.VertexAt(from).value()) == from);
  CHECK(Contains(view(), wall));
}

TEST_CASE("Steps to a goal count the length of edges", "[planner][navigation]") {
  const BuiltGraph built(RasterOf(5, 200, [](Cell cell) { return cell.row != 2; }));
  const RegionGraph& graph = built.graph;
  const auto belief = std::make_shared<const BeliefGrid>(5, 200, 0.0F);
  const SearchProblem problem{.graph = graph,
                              .start = graph.VertexAt({2, 0}).value(),
                              .path = {},
                              .goals_left = {{2, 199}},
                              .guidance = {},
                              .belief = belief,
                              .sent_views = {}};
  const std::vector<double> steps = test::StepsToNearestGoal(problem);
  const int goal = graph.CellOf(graph.VertexAt({2, 199}).value()).column;
  for (VertexId vertex = 0; vertex < graph.vertex_count(); ++vertex) {
    CHECK(steps[static_cast<std::size_t>(vertex)] ==
          Approx((goal - graph.CellOf(vertex).column) / 10.0));
  }
}

TEST_CASE("The search asks about whole regions and finds the way", "[planner][navigation]") {
  const BuiltGraph built(
      RasterOf(40, 40, [](Cell cell) { return cell.column == 20 && cell.row > 5; }), {},
      {.headings = 4, .lens = {}, .range_cells = 15.0});
  const RegionGraph& graph = built.graph;
  const auto belief = std::make_shared<const BeliefGrid>(40, 40, 0.0F);
  const Cell robot{30, 10};
  const VertexId start = graph.VertexAt(robot).value();
  const Cell before = robot + Cell{0, 1};
  REQUIRE(graph.VertexAt(before) == start);
  const SearchProblem problem{.graph = graph,
                              .start = start,
                              .path = {before, robot},
                              .goals_left = {{30, 30}},
                              .guidance = {},
                              .belief = belief,
                              .sent_views = {{robot, graph.HeadingsAt(start)[1]}}};
  ScriptedPerception model([&](int, std::span<const PerceptionQuery> queries) {
    for (const PerceptionQuery& query : queries) {
      for (const Cell cell : graph.CellsOf(start)) REQUIRE(Contains(query.path, cell));
    }
    return FakePerceptionModel().Predict(queries);
  });
  SearchOptions options;
  options.reward.communication_cost = 1000.0;  // in cells of a fine raster
  options.reward.communication_guidance = 0.0;
  Random random(1);
  const SearchResult result = ParallelSearch(options, model).Decide(problem, random).value();
  REQUIRE(result.chosen >= 0);
  const SearchAction& chosen = result.actions[static_cast<std::size_t>(result.chosen)];
  CHECK(chosen.kind == CommandKind::kMove);
  const std::vector<double> steps = test::StepsToNearestGoal(problem);
  CHECK(steps[static_cast<std::size_t>(graph.VertexAt(chosen.target).value())] <
        steps[static_cast<std::size_t>(start)]);
  const auto views =
      std::ranges::count(result.actions, CommandKind::kTransmitView, &SearchAction::kind);
  CHECK(views == 3);  // one was sent already, from another cell of the region
  CHECK(PathState(problem).length() == 1);
}

}  // namespace conav::planner
