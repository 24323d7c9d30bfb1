#include "planner/search/cached_perception_model.h"

#include <catch2/catch.hpp>

#include "conformance/perception_model_conformance.h"
#include "planner/search/fake_perception_model.h"

namespace conav::planner {
namespace {

using conformance::MakeQueries;

class FailingModel final : public PerceptionModel {
 public:
  [[nodiscard]] Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) override {
    if (fails) return Fail(ErrorCode::kTimeout, "nobody answers");
    return model_.Predict(queries);
  }
  std::string name() const override { return "failing"; }
  bool fails = true;

 private:
  FakePerceptionModel model_;
};

TEST_CASE("the cached perception model conforms", "[planner][search][conformance]") {
  FakePerceptionModel reference;
  conformance::CheckPerceptionModelConformance(
      [] {
        return std::make_shared<CachedPerceptionModel>(std::make_shared<FakePerceptionModel>());
      },
      reference);
}

TEST_CASE("a cache of one answer still gives the right ones", "[planner][search][conformance]") {
  FakePerceptionModel reference;
  conformance::CheckPerceptionModelConformance(
      [] {
        return std::make_shared<CachedPerceptionModel>(std::make_shared<FakePerceptionModel>(), 1);
      },
      reference);
}

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

TEST_CASE("every part of a query is part of the key", "[planner][search]") {
  CachedPerceptionModel model(std::make_shared<FakePerceptionModel>());
  const PerceptionQuery query = MakeQueries(1)[0];
  std::vector<PerceptionQuery> variants(6, query);
  variants[1].belief[{4, 4}] = 0.5F;
  variants[2].path.push_back({1, 1});
  variants[3].cell = {1, 1};
  variants[4].heading_rad += 1e-9;
  variants[5].visible.free.clear();
  REQUIRE(model.Predict(variants));
  CHECK(model.counts().asked == 6);
}

TEST_CASE("the oldest answers are dropped when the cache is full", "[planner][search]") {
  CachedPerceptionModel model(std::make_shared<FakePerceptionModel>(), 2);
  const auto queries = MakeQueries(3);
  REQUIRE(model.Predict(queries));  // holds 1 and 2 now
  REQUIRE(model.Predict(std::span(queries).subspan(1)));
  CHECK(model.counts().asked == 3);
  REQUIRE(model.Predict(std::span(queries).first(1)));
  CHECK(model.counts().asked == 4);
}

TEST_CASE("a failure is passed on and not remembered", "[planner][search]") {
  const auto inner = std::make_shared<FailingModel>();
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
