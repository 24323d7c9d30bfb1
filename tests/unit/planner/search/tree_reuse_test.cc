#include "planner/search/tree_reuse.h"

#include <catch2/catch.hpp>

#include "common/msg/perception_model.h"
#include "planner/search/parallel_search.h"
#include "unit/planner/search/text_map.h"

namespace conav::planner {
namespace {

const std::vector<std::string_view> kCorridor{"########", "#S....G#", "#.######", "########"};
/// The same, the second cell is a wall.
const std::vector<std::string_view> kCollapsed{"########", "#S.#..G#", "#.######", "########"};

SearchOptions Reusing(TreeReuse reuse) {
  SearchOptions options;
  options.iterations = 300;
  options.tree_reuse = reuse;
  return options;
}

/// A decision at the start, then one a step further.
class TwoDecisions {
 public:
  explicit TwoDecisions(TreeReuse reuse) : options_(Reusing(reuse)), search_(options_, model_) {}

  SearchResult First(TextWorld& world) { return Decide(world); }
  /// The robot went to (1, 2) in `world`.
  SearchResult Second(TextWorld& world) {
    world.problem.start = world.At(1, 2);
    world.problem.path = {{1, 1}, {1, 2}};
    return Decide(world);
  }

 private:
  SearchResult Decide(TextWorld& world) {
    if (world.problem.path.empty()) world.problem.path = {{1, 1}};
    return search_.Decide(world.problem, random_, {}, &memories_).value();
  }

  SearchOptions options_;
  FakePerceptionModel model_;
  ParallelSearch search_;
  Random random_{3};
  std::vector<SearchMemory> memories_;
};

std::uint32_t Visits(const SearchResult& result) {
  std::uint32_t sum = 0;
  for (const SearchAction& action : result.actions) sum += action.visits;
  return sum;
}

TEST_CASE("the branch of the move that was made is gone on with", "[planner][search]") {
  TwoDecisions decisions(TreeReuse::kPruned);
  TextWorld world(kCorridor);
  const SearchResult first = decisions.First(world);
  REQUIRE(first.actions[0].target == Cell{1, 2});
  const SearchResult second = decisions.Second(world);
  CHECK(second.iterations == 300);
  CHECK(Visits(second) > 300);
  CHECK(Visits(second) <= 300 + first.actions[0].visits);
}

TEST_CASE("a map that changed cuts branches off", "[planner][search]") {
  TwoDecisions decisions(TreeReuse::kPruned);
  TextWorld before(kCorridor);
  decisions.First(before);
  TextWorld after(kCollapsed, kCorridor);
  const SearchResult second = decisions.Second(after);
  CHECK(Visits(second) > 300);
  CHECK(second.actions[0].target == Cell{1, 1});  // the only move left
}

TEST_CASE("without reuse, and with another guidance, belief or place, a new tree is grown",
          "[planner][search]") {
  TwoDecisions decisions(TreeReuse::kPruned);
  TextWorld world(kCorridor);
  decisions.First(world);
  SECTION("no reuse") {
    TwoDecisions without(TreeReuse::kNone);
    TextWorld other(kCorridor);
    without.First(other);
    CHECK(Visits(without.Second(other)) == 300);
  }
  SECTION("guidance") {
    world.problem.guidance = {{1, 1}, {2, 1}};
    CHECK(Visits(decisions.Second(world)) == 300);
  }
  SECTION("belief") {
    TextWorld edited(kCorridor, kCollapsed);
    CHECK(Visits(decisions.Second(edited)) == 300);
  }
  SECTION("a place that is no step away") {
    world.problem.start = world.At(1, 3);
    world.problem.path = {{1, 1}, {1, 2}, {1, 3}};
    SearchMemory memory;
    CHECK_FALSE(memory.BranchFor(world.problem, OfferedActions(world.problem),
                                 Reusing(TreeReuse::kPruned)));
  }
}

}  // namespace
}  // namespace conav::planner
