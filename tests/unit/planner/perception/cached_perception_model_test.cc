#include <catch2/catch.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/msg/perception_model.h"
#include "conformance/perception_model_conformance.h"
#include "planner/perception/cached_model.h"

namespace conav::planner {
namespace {

SharedBelief Belief() {
  return std::make_shared<const BeliefGrid>(conformance::MakeQueries(1)[0].belief);
}

std::vector<ShownView> MakeViews(int count) {
  std::vector<ShownView> views;
  for (const PerceptionQuery& query : conformance::MakeQueries(count)) {
    views.push_back({query.path, query.cell, query.heading_rad, query.visible});
  }
  return views;
}

std::vector<double> Predicted(PerceptionModel& model, std::span<const ShownView> views) {
  const auto edits = model.PredictEdits(Belief(), views);
  REQUIRE(edits);
  return *edits;
}

TEST_CASE("only what is not remembered is asked, each view once", "[planner][search]") {
  CachedPerceptionModel model(std::make_shared<FakePerceptionModel>());
  const auto views = MakeViews(3);
  Predicted(model, std::vector{views[0], views[1], views[0]});
  CHECK(model.counts().asked == 2);
  CHECK(model.counts().cached == 1);
  Predicted(model, views);
  CHECK(model.counts().asked == 3);
  CHECK(model.counts().cached == 3);
  CHECK(model.counts().calls == 2);
  Predicted(model, views);
  CHECK(model.counts().calls == 2);
}

TEST_CASE("path, camera cell, heading and each side of the view are part of the key",
          "[planner][search]") {
  CachedPerceptionModel model(std::make_shared<FakePerceptionModel>());
  std::vector<ShownView> variants(6, MakeViews(1)[0]);
  variants[1].path.push_back({1, 1});
  variants[2].cell = {1, 1};
  variants[3].visible.free.clear();
  variants[4].visible.walls.clear();
  variants[5].heading_rad += 0.5;
  Predicted(model, variants);
  CHECK(model.counts().asked == 6);
  CHECK(model.counts().cached == 0);
}

TEST_CASE("edits are remembered as long as the belief is equal", "[planner][search]") {
  CachedPerceptionModel model(std::make_shared<FakePerceptionModel>());
  const auto ask = [&](const BeliefGrid& belief) {
    REQUIRE(model.PredictEdits(std::make_shared<const BeliefGrid>(belief), MakeViews(2)));
    return model.counts().asked;
  };
  CHECK(ask(*Belief()) == 2);
  CHECK(ask(*Belief()) == 2);
  BeliefGrid edited = *Belief();
  edited[{4, 4}] = 0.5F;
  const std::size_t bytes = model.counts().bytes;
  CHECK(ask(edited) == 4);
  CHECK(ask(edited) == 4);
  CHECK(model.counts().bytes == bytes);  // those of the belief before are forgotten
  // A belief of the same values in another shape is another one.
  const ShownView view{{}, {0, 0}, 0.0, {}};
  for (const auto& [rows, columns] : {std::pair{2, 3}, std::pair{3, 2}}) {
    const auto belief = std::make_shared<const BeliefGrid>(rows, columns, 0.5F);
    REQUIRE(model.PredictEdits(belief, std::vector{view}));
  }
  CHECK(model.counts().asked == 6);
}

// Faults of memory, G8: a planner of 8 robots grew by 3.2 MB/h, an answer with each picture that was sent.
TEST_CASE("what a picture would change is passed on, and nothing of it is kept",
          "[planner][search]") {
  CachedPerceptionModel model(std::make_shared<FakePerceptionModel>());
  const auto queries = conformance::MakeQueries(3);
  CHECK(*model.Predict(queries) == *FakePerceptionModel().Predict(queries));
  CHECK(model.counts().bytes == 0);
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

TEST_CASE("edits are forgotten when another model answers from now on", "[planner][search]") {
  const auto inner = std::make_shared<ChangingModel>();
  CachedPerceptionModel model(inner);
  const auto views = MakeViews(2);
  Predicted(model, views);
  inner->probability = 0.25;
  CHECK(model.identity() == inner->identity());
  CHECK(Predicted(model, views) == Predicted(*inner, views));
  CHECK(model.counts().asked == 4);
  CHECK(model.counts().cached == 0);
}

TEST_CASE("edits that came while the model changed are not remembered", "[planner][search]") {
  const auto inner = std::make_shared<ChangingModel>();
  CachedPerceptionModel model(inner);
  const auto views = MakeViews(2);
  inner->next_probability = 0.25;
  Predicted(model, views);
  CHECK(model.counts().asked == 2);
  CHECK(Predicted(model, views) == Predicted(*inner, views));
  CHECK(model.counts().asked == 4);
}

TEST_CASE("a batch does not mix remembered edits with those of a model that came meanwhile",
          "[planner][search]") {
  const auto inner = std::make_shared<ChangingModel>();
  CachedPerceptionModel model(inner);
  const auto views = MakeViews(3);
  Predicted(model, std::span(views).first(2));
  inner->next_probability = 0.25;
  const auto edits = Predicted(model, views);
  CHECK(edits == Predicted(*inner, views));
  CHECK(model.counts().asked == 2 + 1 + 3);
  CHECK(model.counts().cached == 0);
  Predicted(model, views);
  CHECK(model.counts().cached == 3);
}

TEST_CASE("the oldest edits are dropped when the cache is full", "[planner][search]") {
  const auto views = MakeViews(3);
  const auto expected = Predicted(*std::make_unique<FakePerceptionModel>(), views);
  CachedPerceptionModel unlimited(std::make_shared<FakePerceptionModel>());
  Predicted(unlimited, std::span(views).first(1));
  const std::size_t one = unlimited.counts().bytes;
  CHECK(one > 8 * (views[0].visible.free.size() + views[0].visible.walls.size()));
  CachedPerceptionModel model(std::make_shared<FakePerceptionModel>(), 5 * one / 2);
  CHECK(Predicted(model, views) == expected);  // holds 1 and 2 now
  CHECK(model.counts().bytes <= 5 * one / 2);
  Predicted(model, std::span(views).subspan(1));
  CHECK(model.counts().asked == 3);
  Predicted(model, std::span(views).first(1));
  CHECK(model.counts().asked == 4);
  CachedPerceptionModel none(std::make_shared<FakePerceptionModel>(), 0);
  CHECK(Predicted(none, views) == expected);
  CHECK(none.counts().bytes == 0);
}

TEST_CASE("a failure is passed on and not remembered", "[planner][search]") {
  const auto inner = std::make_shared<ChangingModel>();
  inner->fails = true;
  CachedPerceptionModel model(inner);
  const auto views = MakeViews(2);
  const auto failed = model.PredictEdits(Belief(), views);
  REQUIRE_FALSE(failed.has_value());
  CHECK(failed.error().code == ErrorCode::kTimeout);
  inner->fails = false;
  Predicted(model, views);
}

}  // namespace
}  // namespace conav::planner
