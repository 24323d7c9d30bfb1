#include <catch2/catch.hpp>
#include <cstdlib>
#include <new>
#include <utility>

#include "common/msg/perception_model.h"
#include "planner/search/parallel_search.h"
#include "unit/planner/search/text_map.h"

namespace {

bool counting = false;
long allocations = 0;

}  // namespace

// Every allocation of this program comes by here. It has one thread.
void* operator new(std::size_t size) {
  if (counting) ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace conav::planner {
namespace {

/// Whose own memory is not counted.
class UncountedModel final : public PerceptionModel {
 public:
  Result<std::vector<PerceptionAnswer>> Predict(std::span<const PerceptionQuery> queries) override {
    return model_.Predict(queries);
  }
  Result<std::vector<double>> PredictEdits(const SharedBelief& belief,
                                           std::span<const ShownView> views) override {
    ++calls;
    const bool before = std::exchange(counting, false);
    auto edits = PerceptionModel::PredictEdits(belief, views);
    counting = before;
    return edits;
  }
  ModelIdentity identity() const override { return model_.identity(); }

  int calls = 0;

 private:
  FakePerceptionModel model_;
};

TEST_CASE("an iteration takes no memory, but for cells that the search looks at first",
          "[planner][search]") {
  const TextWorld world({"###########", "#S..#.....#", "#.#.#.###.#", "#.#...#...#", "#.#####.#.#",
                         "#?????..#G#", "###########"},
                        {"###########", "#S..#.....#", "#.#.#.###.#", "#.#...#...#", "#.#####.#.#",
                         "#.##....#G#", "###########"});
  const Expansion expansion = GENERATE(Expansion::kRandom, Expansion::kChain);
  UncountedModel model;
  const auto allocations_of = [&](int iterations) {
    SearchOptions options;
    options.iterations = iterations;
    options.expansion = expansion;
    const ParallelSearch search(options, model);
    Random random(5);
    allocations = 0;
    counting = true;
    const auto decided = search.Decide(world.problem, random);
    counting = false;
    REQUIRE(decided.value().iterations == static_cast<std::uint32_t>(iterations));
    return allocations;
  };
  allocations_of(2000);  // the graph casts each view once and keeps it
  const int calls = model.calls;
  const long of_few = allocations_of(200);
  const int calls_of_few = model.calls - calls;
  const long of_many = allocations_of(2000);
  CHECK(of_many - of_few < 30);                // in 1800 iterations; the map has 45 cells inside
  if (expansion == Expansion::kChain) return;  // moves come first, so it soon has asked about all
  CHECK(model.calls - calls - calls_of_few > calls_of_few);
}

}  // namespace
}  // namespace conav::planner
