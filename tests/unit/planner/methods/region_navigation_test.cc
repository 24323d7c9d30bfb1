#include "planner/methods/region_navigation.h"

#include <catch2/catch.hpp>
#include <set>

#include "planner/decision/traffic.h"
#include "planner/methods/ig_mcts_method.h"
#include "planner/methods/make_method.h"
#include "planner/navigation/cell_line.h"
#include "unit/planner/navigation/raster_worlds.h"
#include "unit/planner/search/text_map.h"

namespace conav::planner {
namespace {

constexpr int kSide = 60;
constexpr double kSensorCells = 12.0;

/// Open water, and between start and goal a bay that opens to the west: who heads for the goal goes
/// in. North of it a channel leads past it.
OccupancyGrid Bay() {
  return RasterOf(kSide, kSide, [](Cell cell) {
    const bool border =
        cell.row == 0 || cell.column == 0 || cell.row == kSide - 1 || cell.column == kSide - 1;
    const bool sides = (cell.row == 20 || cell.row == 45) && cell.column >= 15 && cell.column <= 45;
    const bool end = cell.column == 45 && cell.row >= 20;
    return border || sides || end;
  });
}

Situation SeaSituation(const OccupancyGrid& truth, Cell start, Cell goal) {
  Situation situation;
  situation.state.robot = "r1";
  situation.state.cell = start;
  situation.state.path = {start};
  situation.state.goals_left = {goal};
  situation.map.cell_size_m = 1.0;
  situation.map.cells = OccupancyGrid(truth.rows(), truth.columns(), Occupancy::kUnknown);
  situation.belief.wall_probability = BeliefGrid(truth.rows(), truth.columns(), 0.0F);
  return situation;
}

/// A robot with a range sensor that drives each move's places on the true map, until land stops it.
struct Voyage {
  Voyage(OccupancyGrid world, Cell start, Cell goal, std::unique_ptr<Method> of_robot)
      : truth(std::move(world)),
        method(std::move(of_robot)),
        now(SeaSituation(truth, start, goal)) {
    Look();
  }

  void Look() {
    const VisibleCells seen = CastRange(truth, now.state.cell, kSensorCells);
    for (const Cell cell : seen.free) now.map.cells[cell] = Occupancy::kFree;
    for (const Cell cell : seen.walls) now.map.cells[cell] = Occupancy::kOccupied;
  }

  /// One decision and its consequences; false when the robot does nothing.
  bool Turn() {
    const Decision decision = method->Decide(now, StopToken());
    if (!decision.action) return false;
    if (decision.action->kind == CommandKind::kTransmitView) {
      ++now.state.snapshots;
      now.state.path = {now.state.cell};
      return true;
    }
    const std::vector<Cell>& route = decision.action->route;
    CHECK(route.back() == decision.action->target);
    CHECK(decision.plan.front() == route.front());
    now.state.command_outcome = CommandOutcome::kDone;
    Cell from = now.state.cell;
    for (const Cell place : route) {
      CheckKnownFreeOrUnknown(from, place);
      if (!Drive(from, place)) break;
      from = place;
    }
    return true;
  }

  /// Lines on land that the robot knows of are not driven.
  void CheckKnownFreeOrUnknown(Cell from, Cell to) const {
    CHECK(
        WalkLine(from, to, [&](Cell cell) { return now.map.cells[cell] != Occupancy::kOccupied; }));
  }

  bool Drive(Cell from, Cell to) {
    const bool arrived = WalkLine(from, to, [&](Cell cell) {
      if (truth[cell] == Occupancy::kOccupied) return false;
      if (cell != now.state.cell) {
        now.state.cell = cell;
        now.state.path.push_back(cell);
        ++cells;
      }
      farthest_east = std::max(farthest_east, cell.column);
      std::erase(now.state.goals_left, cell);
      return true;
    });
    Look();
    if (!arrived) now.state.command_outcome = CommandOutcome::kBlocked;
    return arrived;
  }

  bool Reaches(int decisions) {
    while (decisions-- > 0 && !now.state.goals_left.empty() && Turn()) {
    }
    return now.state.goals_left.empty();
  }

  OccupancyGrid truth;
  std::unique_ptr<Method> method;
  Situation now;
  int cells = 0;
  int farthest_east = 0;
};

FakeClock& TestClock() {
  static FakeClock clock;
  return clock;
}

MethodConfig OnRegions() {
  MethodConfig config;
  config.search.UseWaterway();
  config.search.options.iterations = 200;
  config.search.options.time_budget_ms = 0.0;
  config.search.regions.cells_per_seed = 40.0;
  config.search.view_range_cells = kSensorCells;
  config.search.regions.step_length_cells = 6.0;
  return config;
}

std::unique_ptr<Method> MethodOf(MethodKind kind, std::uint64_t seed = 1) {
  return MakeMethod(kind, OnRegions(), seed, std::make_shared<FakePerceptionModel>(), nullptr,
                    TestClock());
}

struct RegionsOf : RegionNavigation {
  explicit RegionsOf(const Situation& situation, const RegionOptions& options = {})
      : RegionNavigation(options) {
    Update(situation, std::make_shared<const GridViews>(GridViews::Options{.headings = 0}));
  }
};

}  // namespace

TEST_CASE(
    "a robot reaches its goal over regions, out of the dead end on the way, and never over land",
    "[planner][regions]") {
  const MethodKind kind = GENERATE(MethodKind::kIgMcts, MethodKind::kGreedy);
  Voyage voyage(Bay(), {32, 5}, {32, 54}, MethodOf(kind));
  CAPTURE(kind);
  CHECK(voyage.Reaches(150));
  CHECK(voyage.farthest_east > 45);
}

namespace {

struct SmoothCrossing {
  OccupancyGrid truth;
  std::vector<Cell> way;  // the longest of the shortest from `start`
  Cell start;
};

SmoothCrossing CrossSmoothTerrain(std::uint64_t seed) {
  Random random(seed);
  const OccupancyGrid truth = Waterway(kSide, 12, random);
  const auto is_free = [&](Cell cell) {
    return !truth.OnBorder(cell) && truth[cell] == Occupancy::kFree;
  };
  Cell start{kSide / 2, kSide / 2};
  while (!is_free(start)) {
    start = {static_cast<int>(random.Uniform(1, kSide - 2)),
             static_cast<int>(random.Uniform(1, kSide - 2))};
  }
  Cell farthest = start;
  PathToNearest(truth, start, is_free, [&](Cell cell) {
    farthest = cell;
    return false;
  });
  return {truth, PathToNearest(truth, start, is_free, [&](Cell cell) { return cell == farthest; }),
          start};
}

/// Vertices that `path` goes to from one without an edge to it.
int JumpsOf(const RegionNavigation& navigation, const std::vector<Cell>& path) {
  int jumps = 0;
  std::optional<VertexId> before;
  for (const Cell cell : path) {
    const auto vertex = navigation.graph().VertexAt(cell);
    if (before && vertex && before != vertex) {
      const auto edges = navigation.graph().EdgesFrom(*before);
      jumps += std::ranges::find(edges, *vertex, &Edge::target) == edges.end() ? 1 : 0;
    }
    before = vertex;
  }
  return jumps;
}

}  // namespace

TEST_CASE("an operator's path can be followed from vertex to vertex", "[planner][regions]") {
  int jumps = 0;
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    const auto [truth, way, start] = CrossSmoothTerrain(seed);
    Situation situation = SeaSituation(truth, start, way.back());
    situation.map.cells = truth;
    const RegionsOf navigation(situation, OnRegions().search.regions);
    jumps += JumpsOf(navigation, navigation.Traversable(way));
    CHECK(JumpsOf(navigation, navigation.FollowablePath(way)) == 0);
  }
  CHECK(jumps > 0);
}

TEST_CASE("a path through land that the robot knows of is not led around it",
          "[planner][regions]") {
  const OccupancyGrid truth = Bay();
  Situation situation = SeaSituation(truth, {32, 5}, {32, 54});
  situation.map.cells = truth;
  const RegionsOf navigation(situation);
  std::vector<Cell> path;
  for (int column = 5; column <= 54; ++column) path.push_back({32, column});
  CHECK(navigation.FollowablePath(path) == navigation.Traversable(path));
}

TEST_CASE("on smooth terrain with an operator's path along the true way the robot arrives",
          "[planner][regions]") {
  const std::uint64_t seed = GENERATE(1, 2, 3, 4);
  const auto [truth, way, start] = CrossSmoothTerrain(seed);
  const Cell goal = way.back();
  Voyage voyage(truth, start, goal, MethodOf(MethodKind::kIgMcts, seed));
  voyage.now.guidance = Guidance{.path = way};
  voyage.now.guided_before = true;
  CAPTURE(seed, start, goal, way.size());
  CHECK(voyage.Reaches(150));
  CHECK(voyage.cells <= 3 * static_cast<int>(way.size()));
}

TEST_CASE("a route goes straight where it can, around land where it cannot, and keeps off corners",
          "[planner][regions]") {
  Situation situation = SeaSituation(OccupancyGrid(9, 12, Occupancy::kFree), {6, 2}, {6, 9});
  situation.map.cells = MapFrom({"############",  //
                                 "#          #",  //
                                 "#    #     #",  //
                                 "#    #     #",  //
                                 "#    #     #",  //
                                 "#    #     #",  //
                                 "#    #     #",  //
                                 "#    #     #",  //
                                 "############"});
  const RegionsOf navigation(situation);
  CHECK(navigation.RouteTo(situation, {3, 2}) == std::vector<Cell>{{3, 2}});
  const std::vector<Cell> around = navigation.RouteTo(situation, {6, 9});
  REQUIRE(around.size() >= 3);
  CHECK(around.back() == Cell{6, 9});
  Cell from = situation.state.cell;
  for (const Cell place : around) {
    CHECK(WalkLine(from, place, [&](Cell cell) {
      return situation.map.cells[cell] == Occupancy::kFree && cell != Cell{2, 5};
    }));
    from = place;
  }
  CHECK(navigation.RouteTo(situation, situation.state.cell).size() == 1);
  situation.state.command_outcome = CommandOutcome::kBlocked;  // somewhere in its cell
  CHECK(navigation.RouteTo(situation, {3, 2}) == std::vector<Cell>{{6, 2}, {3, 2}});
}

TEST_CASE("a robot within its clearance of land gets out, one that is shut in stays",
          "[planner][regions]") {
  Situation situation = SeaSituation(OccupancyGrid(9, 12, Occupancy::kFree), {1, 1}, {1, 10});
  situation.map.cells = RasterOf(
      9, 12, [](Cell cell) { return cell.row == 0 || cell.row == 8 || cell.column % 11 == 0; });
  const RegionsOf navigation(situation, {.clearance_cells = 2.5});
  REQUIRE_FALSE(navigation.graph().VertexAt({1, 1}));
  REQUIRE(navigation.VertexNear({1, 1}) == navigation.graph().VertexAt({3, 3}));
  const auto decision = navigation.ApproachGoal(situation);  // one region
  REQUIRE(decision);
  const std::vector<Cell>& route = decision->action->route;
  CHECK(route.back() == Cell{3, 8});  // as near to the goal as the clearance allows
  situation.state.cell = {3, 8};
  CHECK(navigation.ApproachGoal(situation)->action->target == Cell{1, 10});

  const RegionsOf shut_in(situation, {.clearance_cells = 9.0});
  CHECK_FALSE(shut_in.VertexNear(situation.state.cell));
  CHECK_FALSE(shut_in.ApproachGoal(situation));
  CHECK(shut_in.WayToGoal(situation).empty());
  CHECK(shut_in.RouteTo(situation, {1, 10}).empty());
}

TEST_CASE("a region where another robot stands is not entered", "[planner][regions]") {
  Situation situation = SeaSituation(OccupancyGrid(), {7, 3}, {7, 56});
  situation.map.cells = RasterOf(
      15, 60, [](Cell cell) { return cell.row == 0 || cell.row == 14 || cell.column % 59 == 0; });
  RegionsOf navigation(situation, {.cells_per_seed = 30.0});
  const std::vector<Cell> way = navigation.WayToGoal(situation);
  REQUIRE(way.size() > 2);
  situation.neighbours = {{"r2", way[1], true, {}}};
  const auto views = std::make_shared<const GridViews>(GridViews::Options{.headings = 0});
  navigation.Update(situation, views);
  const std::vector<Cell> past = navigation.WayToGoal(situation);
  REQUIRE_FALSE(past.empty());
  CHECK(std::ranges::find(past, way[1]) == past.end());
  situation.neighbours.clear();
  navigation.Update(situation, views);
  CHECK(navigation.WayToGoal(situation) == way);
}

TEST_CASE("what was prepared ahead changes no decision", "[planner][regions]") {
  const MethodKind kind = GENERATE(MethodKind::kIgMcts, MethodKind::kGreedy);
  Voyage plain(Bay(), {32, 5}, {32, 54}, MethodOf(kind));
  Voyage prepared(Bay(), {32, 5}, {32, 54}, MethodOf(kind));
  for (int i = 0; i < 6; ++i) {
    prepared.method->Prepare(prepared.now.map.cells);
    REQUIRE(plain.Turn() == prepared.Turn());
    REQUIRE(plain.now.state.cell == prepared.now.state.cell);
  }
}

TEST_CASE("information is map area: the same at half the cell size", "[planner][regions]") {
  const auto weight_at = [](double cell_size_m) {
    Situation situation = SeaSituation(OccupancyGrid(20, 20, Occupancy::kFree), {10, 10}, {15, 15});
    situation.map.cells = OccupancyGrid(20, 20, Occupancy::kFree);
    situation.map.cell_size_m = cell_size_m;
    const RegionsOf navigation(situation);
    const SituationProblem problem(
        situation, std::make_shared<const BeliefGrid>(situation.belief.wall_probability), {},
        navigation, {.information_weight = 0.5});
    return problem.get()->information_weight;
  };
  CHECK(weight_at(1.0) == Approx(0.5));
  CHECK(4.0 * weight_at(0.5) == Approx(weight_at(1.0)));
}

TEST_CASE("views count only where they can show what the operator's map has wrong",
          "[planner][regions]") {
  // Open water; the operator takes a square of 36 cells in the east for land.
  Situation situation = SeaSituation(OccupancyGrid(40, 40, Occupancy::kFree), {20, 5}, {20, 35});
  situation.map.cells = OccupancyGrid(40, 40, Occupancy::kFree);
  situation.belief.wall_probability = BeliefGrid(40, 40, 0.0F);
  for (int row = 17; row < 23; ++row) {
    for (int column = 25; column < 31; ++column) {
      situation.belief.wall_probability[{row, column}] = 1.0F;
    }
  }
  RegionNavigation navigation({});
  navigation.Update(situation, ViewsFor(situation, 8));
  const auto poor_at = [&](double range_cells, double least) {
    const SituationProblem problem(
        situation, std::make_shared<const BeliefGrid>(situation.belief.wall_probability), {},
        navigation, {}, range_cells, least);
    REQUIRE(problem.get() != nullptr);
    const auto first = 8 * problem.get()->start;
    return std::vector<std::uint8_t>(problem.get()->poor_views.begin() + first,
                                     problem.get()->poor_views.begin() + first + 8);
  };
  const auto headings = navigation.graph().HeadingsAt(0);
  const std::vector<std::uint8_t> poor = poor_at(50.0, 30.0);
  for (std::size_t i = 0; i < 8; ++i) {
    CHECK((poor[i] == 0) == (std::abs(headings[i]) < 0.8));  // east, and 45 degrees to its sides
  }
  CHECK(std::ranges::count(poor_at(50.0, 40.0), 1) == 8);  // there are not as many
  CHECK(std::ranges::count(poor_at(10.0, 30.0), 1) == 8);  // nor does a view reach so far
  CHECK(std::ranges::count(poor_at(50.0, 0.0), 1) == 0);
}

namespace {

/// Notes how many queries came at once.
class BatchSizes final : public PerceptionModel {
 public:
  Result<std::vector<PerceptionAnswer>> Predict(std::span<const PerceptionQuery> queries) override {
    sizes.push_back(queries.size());
    return model_.Predict(queries);
  }
  ModelIdentity identity() const override { return model_.identity(); }

  std::vector<std::size_t> sizes;

 private:
  FakePerceptionModel model_;
};

}  // namespace

TEST_CASE("on regions the root's headings are asked about in one batch", "[planner][regions]") {
  const auto model = std::make_shared<BatchSizes>();
  MethodConfig config = OnRegions();
  config.search.options.min_information = 0.0;
  config.search.options.reward.communication_cost = 0.0;  // any view may be worth it
  Voyage voyage(Bay(), {32, 5}, {32, 54},
                MakeMethod(MethodKind::kIgMcts, config, 1, model, nullptr, TestClock()));
  REQUIRE(voyage.Turn());
  REQUIRE_FALSE(model->sizes.empty());
  CHECK(model->sizes.front() == 8);
  CHECK(std::ranges::count(model->sizes, 8U) == 1);
}

TEST_CASE("a view that was sent within the clearance of land is not offered again",
          "[planner][regions]") {
  Situation situation = SeaSituation(OccupancyGrid(12, 40), {1, 1}, {1, 30});
  situation.map.cells = RasterOf(
      12, 40, [](Cell cell) { return cell.row == 0 || cell.row == 11 || cell.column % 39 == 0; });
  RegionNavigation navigation({.clearance_cells = 2.5});
  navigation.Update(situation, ViewsFor(situation, 8));
  const SituationProblem problem(
      situation, std::make_shared<const BeliefGrid>(situation.belief.wall_probability),
      {{{1, 1}, 0.0}}, navigation);
  REQUIRE(problem.get() != nullptr);
  OfferedActions offered(*problem.get());
  CHECK(offered.At(problem.get()->start).views.size() == 7);
}

TEST_CASE("the waterway's preset decides on regions with a budget of time", "[planner][regions]") {
  SearchConfig config;
  ReadConfig(YAML::Load("{preset: waterway, regions: {clearance_cells: 2}, headings: 12}"),
             "search", config);
  CHECK(config.graph == SearchGraph::kRegions);
  CHECK(config.regions.clearance_cells == 2.0);
  CHECK(config.view_range_cells == 50.0);
  CHECK(config.options.time_budget_ms > 0.0);
  CHECK(config.options.reward.communication_cost == 60.0);
  CHECK(config.options.reward.communication_guidance == 0.0);
  CHECK(config.believed_wall_steps == 10);
  CHECK(config.off_guidance_steps == 3);
  const YAML::Node document = YAML::Load(DumpConfig("search", config));
  SearchConfig again;
  ReadConfig(document["search"]["ros__parameters"], "search", again);
  CHECK(again.graph == SearchGraph::kRegions);
  CHECK(again.regions == config.regions);
  CHECK(again.headings == 12);
}

TEST_CASE("what does not fit the graph of regions is refused by name", "[planner][regions]") {
  const auto& [text, key] = GENERATE(table<std::string, std::string>({
      {"{graph: voronoi}", "graph"},
      {"{graph: regions, headings: 40}", "headings"},
      {"{graph: regions, tree_reuse: pruned}", "tree_reuse"},
      {"{regions: {cells_per_seed: 0}}", "cells_per_seed"},
      {"{view_range_cells: -1}", "view_range_cells"},
      {"{off_guidance_steps: 0}", "off_guidance_steps"},
      {"{believed_wall_steps: 21}", "believed_wall_steps"},
  }));
  SearchConfig config;
  CHECK_THROWS_WITH(ReadConfig(YAML::Load(text), "search", config), Catch::Contains(key));
}

}  // namespace conav::planner
