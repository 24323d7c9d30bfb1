#include <catch2/catch.hpp>
#include <functional>

#include "planner/methods/operator_model.h"

using namespace conav;
using conav::PerceptionModel;
using conav::planner::BeliefEstimate;

namespace {

/// Expects half of what could be added and a quarter of what could be removed to be edited.
class HalfModel final : public PerceptionModel {
 public:
  Result<std::vector<PerceptionAnswer>> Predict(std::span<const PerceptionQuery> queries) override {
    if (failure) return tl::unexpected(*failure);
    asked = queries[0];
    if (while_asked) while_asked();
    PerceptionAnswer answer{queries[0].belief, queries[0].belief};
    for (float& x : answer.add.values()) x = 0.5F * (1.0F - x);
    for (float& x : answer.remove.values()) x = 0.25F * x;
    return std::vector{answer};
  }
  ModelIdentity identity() const override { return {"half", "", ""}; }

  PerceptionQuery asked;
  std::optional<Error> failure;
  std::function<void()> while_asked;
};

struct EstimateBench {
  EstimateBench() { published[{0, 1}] = 1.0F; }

  BeliefGrid published{1, 2, 0.0F};
  std::shared_ptr<HalfModel> model = std::make_shared<HalfModel>();
  BeliefEstimate estimate{model};
};

}  // namespace

TEST_CASE("an estimate starts with the first published map and then goes its own way",
          "[planner][belief_estimate]") {
  EstimateBench bench;
  CHECK(bench.estimate.Now(bench.published) == bench.published);
  CHECK(bench.estimate.Now(BeliefGrid(1, 2, 0.5F)) == bench.published);
}

TEST_CASE("a sent picture moves the estimate by x (1 - p_remove) + (1 - x) p_add",
          "[planner][belief_estimate]") {
  EstimateBench bench;
  bench.estimate.Now(bench.published);
  const PerceptionQuery asked{bench.published, {{0, 0}, {0, 1}}, {0, 1}, 0.5, {{{0, 0}}, {{0, 1}}}};
  REQUIRE(bench.estimate.NoteSent(asked.path, asked.cell, asked.heading_rad, asked.visible));
  CHECK(bench.model->asked == asked);
  const BeliefGrid once = bench.estimate.Now(bench.published);
  CHECK(once[{0, 0}] == 0.5F);
  CHECK(once[{0, 1}] == 0.75F);
  REQUIRE(bench.estimate.NoteSent({}, {0, 0}, 0.0, {}));
  const BeliefGrid twice = bench.estimate.Now(bench.published);
  CHECK(twice[{0, 0}] == 0.5F * 0.75F + 0.5F * 0.5F);
  CHECK(twice[{0, 1}] == 0.75F * 0.75F + 0.25F * 0.5F);
}

TEST_CASE("when the model fails the estimate stays", "[planner][belief_estimate]") {
  EstimateBench bench;
  bench.estimate.Now(bench.published);
  bench.model->failure = Error{ErrorCode::kTimeout, "gone"};
  const auto noted = bench.estimate.NoteSent({}, {0, 0}, 0.0, {});
  REQUIRE_FALSE(noted);
  CHECK(noted.error().text == "gone");
  CHECK(bench.estimate.Now(bench.published) == bench.published);
}

TEST_CASE("a world that starts again with a map of another size gets a new estimate",
          "[planner][belief_estimate]") {
  EstimateBench bench;
  bench.estimate.Now(bench.published);
  const BeliefGrid larger(2, 2, 0.5F);
  SECTION("after a picture") {}
  SECTION("while the model is asked about a picture of the old one, by another robot") {
    bench.model->while_asked = [&] { bench.estimate.Now(larger); };
  }
  REQUIRE(bench.estimate.NoteSent({}, {0, 0}, 0.0, {}));
  CHECK(bench.estimate.Now(larger) == larger);
}
