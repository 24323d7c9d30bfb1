#include "planner/search/parallel_search.h"

#include <array>
#include <catch2/catch.hpp>

#include "planner/perception/cached_model.h"
#include "planner/search/tree_report.h"
#include "unit/planner/search/text_map.h"

namespace conav::planner {
namespace {

SearchResult Tree(std::vector<std::pair<std::uint32_t, double>> visits_and_means) {
  SearchResult tree;
  for (const auto& [visits, mean] : visits_and_means) {
    SearchAction action;
    action.visits = visits;
    action.mean_value = mean;
    tree.actions.push_back(action);
    tree.iterations += visits;
  }
  tree.expected_path = {{1, 1}};
  return tree;
}

TEST_CASE("visits and returns of the trees are summed, and the most visited action is chosen",
          "[planner][search]") {
  const std::array trees{Tree({{6, 1.0}, {4, -2.0}}), Tree({{1, 8.0}, {9, 3.0}}), SearchResult{}};
  const SearchResult sum = SumOfTrees(trees);
  CHECK(sum.actions[0].visits == 7);
  CHECK(sum.actions[0].mean_value == Approx((6 * 1.0 + 8.0) / 7));
  CHECK(sum.actions[1].visits == 13);
  CHECK(sum.actions[1].mean_value == Approx((4 * -2.0 + 9 * 3.0) / 13));
  CHECK(sum.chosen == 1);
  CHECK(sum.iterations == 20);
  CHECK(sum.expected_path.empty());
  CHECK(TreeWithMostVisits(trees, 0) == 0);
  CHECK(TreeWithMostVisits(trees, 1) == 1);
}

TEST_CASE("equal visits: the higher mean, then the lower number, nothing visited, nothing chosen",
          "[planner][search]") {
  CHECK(SumOfTrees(std::array{Tree({{5, 1.0}, {5, 2.0}})}).chosen == 1);
  CHECK(SumOfTrees(std::array{Tree({{5, 2.0}, {5, 2.0}})}).chosen == 0);
  CHECK(SumOfTrees(std::array{Tree({{0, 0.0}})}).chosen == -1);
}

/// Some of it unknown, and the operator does not know of a wall.
struct World : TextWorld {
  World()
      : TextWorld({"#########", "#S..?...#", "#.#.#.#.#", "#..?....#", "#.#.#.#G#", "#########"},
                  {"#########", "#S..#...#", "#.#.#.#.#", "#...#...#", "#.#.#.#G#", "#########"}) {}
};

SearchOptions Trees(int trees, int threads) {
  SearchOptions options;
  options.iterations = 300;
  options.trees = trees;
  options.tree_threads = threads;
  return options;
}

SearchResult Decide(const SearchOptions& options, std::uint64_t seed = 1) {
  return Decide(World().problem, options, seed);
}

TEST_CASE("several trees decide the same whatever the number of threads", "[planner][search]") {
  const SearchResult alone = Decide(Trees(4, 1));
  CHECK(alone.iterations == 4 * 300);
  for (const int threads : {2, 4, 7}) {
    const SearchResult together = Decide(Trees(4, threads));
    CHECK(together == alone);  // the report
    CHECK(together.expected_path == alone.expected_path);
  }
  CHECK_FALSE(Decide(Trees(4, 2), 2).actions == alone.actions);
  CHECK_FALSE(Decide(Trees(3, 2)).actions == alone.actions);
}

TEST_CASE("decisions in a row with trees that are gone on with are the same on all threads",
          "[planner][search]") {
  const auto visits = [](int threads) {
    World world;
    const auto model =
        std::make_shared<CachedPerceptionModel>(std::make_shared<FakePerceptionModel>());
    SearchOptions options = Trees(3, threads);
    options.tree_reuse = TreeReuse::kPruned;
    const ParallelSearch search(options, *model);
    std::vector<SearchMemory> memories;
    Random random(5);
    world.problem.path = {{1, 1}};
    std::vector<std::uint32_t> all;
    for (const Cell next : {Cell{1, 1}, Cell{1, 2}, Cell{1, 3}}) {
      world.problem.start = world.graph.VertexAt(next).value();
      if (next != world.problem.path.back()) world.problem.path.push_back(next);
      const auto result = search.Decide(world.problem, random, {}, &memories).value();
      for (const SearchAction& action : result.actions) all.push_back(action.visits);
    }
    return all;
  };
  const auto alone = visits(1);
  CHECK(visits(2) == alone);
  CHECK(visits(4) == alone);
}

TEST_CASE("the expected path begins with the action that the trees chose together",
          "[planner][search]") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const SearchResult result = Decide(Trees(3, 2), seed);
    const SearchAction& chosen = result.actions.at(static_cast<std::size_t>(result.chosen));
    if (chosen.kind == CommandKind::kMove) {
      REQUIRE_FALSE(result.expected_path.empty());
      CHECK(result.expected_path.front() == chosen.target);
    } else {
      CHECK(result.expected_path.empty());
    }
  }
}

TEST_CASE("trees stop when asked to, and fail when the model does", "[planner][search]") {
  const World world;
  Random random(1);
  ScriptedPerception gone([](int calls, auto queries) -> ScriptedPerception::Answers {
    if (calls > 3) return Fail(ErrorCode::kUnavailable, "gone");
    return FakePerceptionModel().Predict(queries);
  });
  CHECK_FALSE(ParallelSearch(Trees(4, 2), gone).Decide(world.problem, random).has_value());
  FakePerceptionModel model;
  StopToken stop;
  stop.RequestStop();
  const auto stopped =
      ParallelSearch(Trees(4, 2), model).Decide(world.problem, random, {.stop = &stop});
  CHECK(stopped.value().iterations == 2);  // one a thread
  CHECK(stopped->chosen >= 0);
}

using std::chrono::milliseconds;

/// Every look at it takes a millisecond.
class LookedAtClock final : public Clock {
 public:
  TimePoint Now() const override { return TimePoint() + milliseconds(looks_++); }
  int looks() const { return looks_; }

 private:
  mutable int looks_ = 0;
};

constexpr milliseconds kTimeout{2000};

/// Answers the first questions at once; each later one takes as long as a timeout.
ScriptedPerception SlowModel(FakeClock& clock, int quick_calls) {
  return ScriptedPerception([&clock, quick_calls](int calls, auto queries) {
    if (calls > quick_calls) clock.Advance(kTimeout);
    return FakePerceptionModel().Predict(queries);
  });
}

SearchOptions WithBudget(double milliseconds) {
  SearchOptions options;
  options.iterations = 1'000'000;
  options.time_budget_ms = milliseconds;
  return options;
}

SearchResult Decide(const SearchOptions& options, PerceptionModel& model, const Clock& clock,
                    std::uint64_t seed = 1) {
  const World world;
  Random random(seed);
  return ParallelSearch(options, model).Decide(world.problem, random, {.clock = &clock}).value();
}

TEST_CASE(
    "the clock is looked at once at first and once after each iteration, and the search ends "
    "at the first look past its budget",
    "[planner][search]") {
  FakePerceptionModel model;
  LookedAtClock clock;
  SearchOptions options = WithBudget(5.0);
  options.trees = GENERATE(1, 3);
  const auto result = Decide(options, model, clock);
  // Looks 0 (the budget ends at 5), 1, ... 5, the last ones after an iteration each.
  CHECK(clock.looks() == 6);
  CHECK(result.iterations == 5);
  CHECK(result.chosen >= 0);
}

TEST_CASE("without a budget of time nobody looks at the clock", "[planner][search]") {
  FakePerceptionModel model;
  LookedAtClock clock;
  SearchOptions options;
  options.iterations = 10;
  CHECK(Decide(options, model, clock).iterations == 10);
  CHECK(clock.looks() == 0);
}

TEST_CASE("one slow question in the middle of a search ends it", "[planner][search]") {
  FakeClock clock;
  const int quick_calls = GENERATE(1, 2, 5);
  ScriptedPerception model = SlowModel(clock, quick_calls);
  const auto start = clock.Now();
  const auto result = Decide(WithBudget(5.0), model, clock);
  CHECK(model.calls == quick_calls + 1);
  CHECK(clock.Now() - start == kTimeout);
  CHECK(result.chosen >= 0);
}

TEST_CASE("a root whose views take all of the time leaves one iteration, with one question at most",
          "[planner][search]") {
  FakeClock clock;
  ScriptedPerception model = SlowModel(clock, 0);
  const std::uint64_t seed = GENERATE(1, 2, 3, 4);
  const auto start = clock.Now();
  const auto result = Decide(WithBudget(5.0), model, clock, seed);
  CHECK(result.iterations == 1);
  CHECK(clock.Now() - start <= 2 * kTimeout);
  CHECK(result.chosen >= 0);
}

}  // namespace
}  // namespace conav::planner
