#include <catch2/catch.hpp>

#include "common/msg/perception_model.h"
#include "planner/search/parallel_search.h"
#include "planner/search/search_options.h"
#include "unit/planner/search/text_map.h"

namespace conav::planner {
namespace {

using std::chrono::milliseconds;

/// Every look at it takes a millisecond.
class LookedAtClock final : public Clock {
 public:
  TimePoint Now() const override { return TimePoint() + milliseconds(looks_++); }
  int looks() const { return looks_; }

 private:
  mutable int looks_ = 0;
};

/// The first questions are answered at once; each later one takes as long as a timeout.
class SlowModel final : public PerceptionModel {
 public:
  SlowModel(FakeClock& clock, int quick_calls) : clock_(clock), quick_calls_(quick_calls) {}

  [[nodiscard]] Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) override {
    if (calls++ >= quick_calls_) clock_.Advance(kTimeout);
    return model_.Predict(queries);
  }
  ModelIdentity identity() const override { return {"slow", "", ""}; }

  static constexpr milliseconds kTimeout{2000};
  int calls = 0;

 private:
  FakeClock& clock_;
  int quick_calls_;
  FakePerceptionModel model_;
};

SearchOptions WithBudget(double milliseconds) {
  SearchOptions options;
  options.iterations = 1'000'000;
  options.time_budget_ms = milliseconds;
  return options;
}

/// The operator does not know of a wall, so that views are worth something.
struct World : TextWorld {
  World()
      : TextWorld({"########", "#S.#..G#", "#......#", "########"},
                  {"########", "#S....G#", "#......#", "########"}) {}
};

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
  SlowModel model(clock, quick_calls);
  const auto start = clock.Now();
  const auto result = Decide(WithBudget(5.0), model, clock);
  CHECK(model.calls == quick_calls + 1);
  CHECK(clock.Now() - start == SlowModel::kTimeout);
  CHECK(result.chosen >= 0);
}

TEST_CASE("a root whose views take all of the time leaves one iteration, with one question at most",
          "[planner][search]") {
  FakeClock clock;
  SlowModel model(clock, 0);
  const std::uint64_t seed = GENERATE(1, 2, 3, 4);
  const auto start = clock.Now();
  const auto result = Decide(WithBudget(5.0), model, clock, seed);
  CHECK(result.iterations == 1);
  CHECK(clock.Now() - start <= 2 * SlowModel::kTimeout);
  CHECK(result.chosen >= 0);
}

}  // namespace
}  // namespace conav::planner
