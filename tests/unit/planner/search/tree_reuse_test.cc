#include "planner/search/tree_reuse.h"

#include <catch2/catch.hpp>

#include "unit/planner/search/text_map.h"

namespace conav::planner {
namespace {

const std::vector<std::string_view> kCorridor{"########", "#S....G#", "#.######", "########"};
/// The same, the second cell is a wall.
const std::vector<std::string_view> kCollapsed{"########", "#S.#..G#", "#.######", "########"};

constexpr std::uint32_t kIterations = 300;

std::uint32_t Visits(const SearchResult& result) {
  std::uint32_t sum = 0;
  for (const SearchAction& action : result.actions) sum += action.visits;
  return sum;
}

/// A decision at the start, then one after a step, in `after`.
struct TwoDecisions {
  explicit TwoDecisions(TreeReuse reuse = TreeReuse::kPruned) {
    options.iterations = kIterations;
    options.tree_reuse = reuse;
    TextWorld before(kCorridor);
    before.problem.path = {{1, 1}};
    first = Decide(before.problem, options, 1, &memories);
  }
  SearchResult Second(SearchProblem problem, std::vector<Cell> path = {{1, 1}, {1, 2}}) {
    problem.start = problem.graph.VertexAt(path.back()).value();
    problem.path = std::move(path);
    return Decide(problem, options, 2, &memories);
  }

  SearchOptions options;
  std::vector<SearchMemory> memories;
  SearchResult first;
};

TEST_CASE("the branch of the move that was made is gone on with", "[planner][search]") {
  TwoDecisions decisions;
  REQUIRE(decisions.first.actions[0].target == Cell{1, 2});
  const SearchResult second = decisions.Second(TextWorld(kCorridor).problem);
  CHECK(second.iterations == kIterations);
  CHECK(Visits(second) > kIterations);
  CHECK(Visits(second) <= kIterations + decisions.first.actions[0].visits);
}

TEST_CASE("a map that changed cuts branches off", "[planner][search]") {
  const SearchResult second = TwoDecisions().Second(TextWorld(kCollapsed, kCorridor).problem);
  CHECK(Visits(second) > kIterations);
  CHECK(second.actions[0].target == Cell{1, 1});  // the only move left
}

TEST_CASE("without reuse, and with another guidance, belief or place, a new tree is grown",
          "[planner][search]") {
  TextWorld guided(kCorridor);
  guided.problem.guidance = {{1, 1}, {2, 1}};
  const TextWorld same(kCorridor), edited(kCorridor, kCollapsed);
  CHECK(Visits(TwoDecisions(TreeReuse::kNone).Second(same.problem)) == kIterations);
  CHECK(Visits(TwoDecisions().Second(guided.problem)) == kIterations);
  CHECK(Visits(TwoDecisions().Second(edited.problem)) == kIterations);
  CHECK(Visits(TwoDecisions().Second(same.problem, {{1, 1}, {1, 2}, {1, 3}})) == kIterations);
}

}  // namespace
}  // namespace conav::planner
