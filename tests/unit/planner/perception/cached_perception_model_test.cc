#include <algorithm>
#include <catch2/catch.hpp>
#include <optional>

#include "common/msg/perception_model.h"
#include "conformance/perception_model_conformance.h"
#include "planner/perception/cached_model.h"

namespace conav::planner {
namespace {

using conformance::MakeQueries;

TEST_CASE("only what is not remembered is asked, each question once", "[planner][search]") {
  CachedPerceptionModel model(std::make_shared<FakePerceptionModel>());
  const auto queries = MakeQueries(3);
  REQUIRE(model.Predict(std::vector{queries[0], queries[1], queries[0]}));
  CHECK(model.counts().asked == 2);
  CHECK(model.counts().cached == 1);
  REQUIRE(model.Predict(queries));
  CHECK(model.counts().asked == 3);
  CHECK(model.counts().cached == 3);
  CHECK(model.counts().calls == 2);
  REQUIRE(model.Predict(queries));
  CHECK(model.counts().calls == 2);
}

TEST_CASE("belief, path, camera cell, heading and each side of the view are part of the key",
          "[planner][search]") {
  CachedPerceptionModel model(std::make_shared<FakePerceptionModel>());
  std::vector<PerceptionQuery> variants(8, MakeQueries(1)[0]);
  variants[1].belief[{4, 4}] = 0.5F;
  variants[2].path.push_back({1, 1});
  variants[3].cell = {1, 1};
  variants[4].visible.free.clear();
  variants[5].visible.walls.clear();
  variants[6].heading_rad += 0.5;
  // The order of the path and repeats are not.
  std::reverse(variants[7].path.begin(), variants[7].path.end());
  variants[7].path.push_back(variants[7].path.front());
  // A belief of the same values in another shape is another question.
  variants.push_back({BeliefGrid(2, 3, 0.5F), {}, {0, 0}, 0.0, {}});
  variants.push_back({BeliefGrid(3, 2, 0.5F), {}, {0, 0}, 0.0, {}});
  const auto answers = model.Predict(variants);
  REQUIRE(answers);
  CHECK(answers->at(9).add.rows() == 3);
  CHECK(model.counts().asked == 7 + 2);
  CHECK(model.counts().cached == 1);
}

TEST_CASE("edits are remembered as long as the belief is equal", "[planner][search]") {
  CachedPerceptionModel model(std::make_shared<FakePerceptionModel>());
  const PerceptionQuery query = MakeQueries(1)[0];
  const ShownView view{query.path, query.cell, query.heading_rad, query.visible};
  ShownView other = view;
  other.visible.walls.clear();
  const auto ask = [&](const BeliefGrid& belief) {
    REQUIRE(
        model.PredictEdits(std::make_shared<const BeliefGrid>(belief), std::vector{view, other}));
    return model.counts().asked;
  };
  CHECK(ask(query.belief) == 2);
  CHECK(ask(query.belief) == 2);
  BeliefGrid edited = query.belief;
  edited[{4, 4}] = 0.5F;
  const std::size_t bytes = model.counts().bytes;
  CHECK(ask(edited) == 4);
  CHECK(ask(edited) == 4);
  CHECK(model.counts().bytes == bytes);  // those of the belief before are forgotten
}

/// Fails, or is another model from one moment to the next, as a service with other weights.
class ChangingModel final : public PerceptionModel {
 public:
  [[nodiscard]] Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) override {
    if (fails) return Fail(ErrorCode::kTimeout, "nobody answers");
    auto answers = FakePerceptionModel({.near_probability = probability}).Predict(queries);
    if (next_probability) probability = *next_probability;
    return answers;
  }
  ModelIdentity identity() const override { return {"changing", "", std::to_string(probability)}; }
  bool fails = false;
  double probability = 0.5;
  std::optional<double> next_probability;  // from the end of the next Predict() on
};

TEST_CASE("answers are forgotten when another model answers from now on", "[planner][search]") {
  const auto inner = std::make_shared<ChangingModel>();
  CachedPerceptionModel model(inner);
  const auto queries = MakeQueries(2);
  REQUIRE(model.Predict(queries));
  inner->probability = 0.25;
  CHECK(model.identity() == inner->identity());
  CHECK(*model.Predict(queries) == *inner->Predict(queries));
  CHECK(model.counts().asked == 4);
  CHECK(model.counts().cached == 0);
}

TEST_CASE("answers that came while the model changed are not remembered", "[planner][search]") {
  const auto inner = std::make_shared<ChangingModel>();
  CachedPerceptionModel model(inner);
  const auto queries = MakeQueries(2);
  inner->next_probability = 0.25;
  REQUIRE(model.Predict(queries));
  CHECK(model.counts().asked == 2);
  CHECK(*model.Predict(queries) == *inner->Predict(queries));
  CHECK(model.counts().asked == 4);
}

TEST_CASE("a batch does not mix remembered answers with those of a model that came meanwhile",
          "[planner][search]") {
  const auto inner = std::make_shared<ChangingModel>();
  CachedPerceptionModel model(inner);
  const auto queries = MakeQueries(3);
  REQUIRE(model.Predict(std::span(queries).first(2)));
  inner->next_probability = 0.25;
  const auto answers = model.Predict(queries);
  CHECK(*answers == *inner->Predict(queries));
  CHECK(model.counts().asked == 2 + 1 + 3);
  CHECK(model.counts().cached == 0);
  REQUIRE(model.Predict(queries));
  CHECK(model.counts().cached == 3);
}

TEST_CASE("the oldest answers are dropped when the cache is full", "[planner][search]") {
  const auto queries = MakeQueries(3);
  CachedPerceptionModel unlimited(std::make_shared<FakePerceptionModel>());
  REQUIRE(unlimited.Predict(std::span(queries).first(1)));
  const std::size_t one = unlimited.counts().bytes;
  CHECK(one > queries[0].belief.size() * 12);
  CachedPerceptionModel model(std::make_shared<FakePerceptionModel>(), 5 * one / 2);
  CHECK(*model.Predict(queries) == *FakePerceptionModel().Predict(queries));  // holds 1 and 2 now
  CHECK(model.counts().bytes <= 5 * one / 2);
  REQUIRE(model.Predict(std::span(queries).subspan(1)));
  CHECK(model.counts().asked == 3);
  REQUIRE(model.Predict(std::span(queries).first(1)));
  CHECK(model.counts().asked == 4);
  CachedPerceptionModel none(std::make_shared<FakePerceptionModel>(), 0);
  CHECK(*none.Predict(queries) == *FakePerceptionModel().Predict(queries));
  CHECK(none.counts().bytes == 0);
}

TEST_CASE("a failure is passed on and not remembered", "[planner][search]") {
  const auto inner = std::make_shared<ChangingModel>();
  inner->fails = true;
  CachedPerceptionModel model(inner);
  const auto queries = MakeQueries(2);
  const auto failed = model.Predict(queries);
  REQUIRE_FALSE(failed.has_value());
  CHECK(failed.error().code == ErrorCode::kTimeout);
  inner->fails = false;
  REQUIRE(model.Predict(queries).has_value());
}

}  // namespace
}  // namespace conav::planner
