#include "planner/search/grid_steps.h"

#include <catch2/catch.hpp>
#include <memory>

#include "common/runtime/random.h"
#include "planner/search/path_state.h"
#include "support/steps_to_goals.h"
#include "unit/planner/search/text_map.h"

namespace conav::planner {
namespace {

/// What a robot knows of a map, robots that stand in its way, and goals, all changing.
struct ChangingWorld {
  explicit ChangingWorld(std::uint64_t seed) : random(seed), known(20, 30, Occupancy::kUnknown) {}

  Cell AnyCell() {
    return {static_cast<int>(random.Uniform(0, 19)), static_cast<int>(random.Uniform(0, 29))};
  }
  void Change() {
    for (int i = 0; i < 12; ++i) {
      known[AnyCell()] = random.Chance(0.6)   ? Occupancy::kFree
                         : random.Chance(0.7) ? Occupancy::kOccupied
                                              : Occupancy::kUnknown;
    }
    occupied.clear();
    for (int i = 0; i < 3; ++i) occupied.push_back(AnyCell());
    if (goals.empty() || random.Chance(0.2)) goals.push_back(AnyCell());
    if (random.Chance(0.1)) goals.erase(goals.begin());
    if (random.Chance(0.5)) ChangeBelief();
    if (random.Chance(0.3)) guidance.clear();
    if (random.Chance(0.5)) guidance.push_back(AnyCell());
  }
  void ChangeBelief() {
    BeliefGrid edited = *belief;
    for (int i = 0; i < 6; ++i) edited[AnyCell()] = random.Chance(0.5) ? 0.9F : 0.1F;
    belief = std::make_shared<const BeliefGrid>(std::move(edited));
  }

  Random random;
  OccupancyGrid known;
  SharedBelief belief = std::make_shared<const BeliefGrid>(20, 30, 0.0F);
  std::vector<Cell> occupied;
  std::vector<Cell> goals;
  std::vector<Cell> guidance;
};

}  // namespace

TEST_CASE("steps kept from decision to decision are those of a new search", "[planner][search]") {
  ChangingWorld world(GENERATE(1, 2, 3, 4));
  const auto [believed_wall_steps, off_guidance_steps] =
      GENERATE(table<int, int>({{1, 1}, {10, 1}, {1, 3}, {10, 3}}));
  const auto steps = std::make_shared<GridSteps>();
  const auto views = std::make_shared<const GridViews>(GridViews::Options());
  for (int change = 0; change < 60; ++change) {
    world.Change();
    const GridGraph graph(world.known, world.occupied, views, steps);
    const auto start = graph.VertexAt(world.AnyCell());
    if (!start) continue;
    const SearchProblem problem{.graph = graph,
                                .start = *start,
                                .path = {},
                                .goals_left = world.goals,
                                .guidance = world.guidance,
                                .belief = world.belief,
                                .sent_views = {},
                                .believed_wall_steps = believed_wall_steps,
                                .off_guidance_steps = off_guidance_steps};
    const std::vector<double> all = test::StepsToNearestGoal(problem);
    const PathState path(problem);
    int wrong = 0;
    for (int i = 0; i < 200; ++i) {
      const auto vertex = static_cast<VertexId>(world.random.Uniform(0, 599));
      if (!graph.VertexAt(graph.CellOf(vertex))) continue;
      wrong += path.StepsToGoal(vertex) == all[static_cast<std::size_t>(vertex)] ? 0 : 1;
    }
    CAPTURE(change);
    REQUIRE(wrong == 0);
  }
}

TEST_CASE("what is far from a change, and from what is asked, is not worked out again",
          "[planner][search]") {
  OccupancyGrid known(200, 200, Occupancy::kFree);
  GridSteps steps;
  const auto at = [&](Cell cell) { return static_cast<VertexId>(known.IndexOf(cell)); };
  steps.Update(known, {}, {at({100, 100})});
  CHECK(steps.From(at({100, 110})) == 10.0);
  CHECK(steps.worked_out() < 1000);  // of 40,000
  CHECK(steps.From(at({1, 1})) == 198.0);
  const std::uint64_t before = steps.worked_out();
  known[{100, 150}] = Occupancy::kOccupied;
  steps.Update(known, {}, {at({100, 100})});
  CHECK(steps.From(at({100, 149})) == 49.0);
  CHECK(steps.From(at({100, 151})) == 53.0);
  CHECK(steps.worked_out() - before < 200);
}

TEST_CASE("another robot that goes to and fro far away takes no more memory each time",
          "[planner][search]") {
  OccupancyGrid known(20, 20, Occupancy::kFree);
  GridSteps steps;
  const auto at = [&](Cell cell) { return static_cast<VertexId>(known.IndexOf(cell)); };
  steps.Update(known, {}, {at({1, 1})});
  CHECK(steps.From(at({18, 18})) == 34.0);
  for (int i = 0; i < 2000; ++i) {
    steps.Update(known, {{17, 17 + i % 2}}, {at({1, 1})});
    CHECK(steps.From(at({1, 3})) == 2.0);
  }
  CHECK(steps.waiting() <= 4 * known.size());
  CHECK(steps.From(at({18, 18})) == 34.0);
}

}  // namespace conav::planner
