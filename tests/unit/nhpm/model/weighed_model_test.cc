#include "nhpm/model/weighed_model.h"

#include <catch2/catch.hpp>

namespace conav::nhpm {
namespace {

/// Expects an edit of each cell with one probability.
class EvenModel final : public PerceptionModel {
 public:
  EvenModel(std::string name, float probability)
      : name_(std::move(name)), probability_(probability) {}
  Result<std::vector<PerceptionAnswer>> Predict(std::span<const PerceptionQuery> queries) override {
    return std::vector<PerceptionAnswer>(
        queries.size(), PerceptionAnswer{Grid<float>(3, 4, probability_), Grid<float>(3, 4)});
  }
  ModelIdentity identity() const override { return {name_, "", ""}; }

 private:
  std::string name_;
  float probability_;
};

TEST_CASE("Two models are weighed by how well they predict this person's edits", "[nhpm]") {
  WeighedPerceptionModel model(std::make_shared<EvenModel>("nhpm", 0.9F),
                               std::make_shared<EvenModel>("glpf", 0.3F));
  const auto belief = std::make_shared<const BeliefGrid>(3, 4);
  const PerceptionQuery query{.belief = *belief, .path = {{1, 1}}, .cell = {1, 1}};
  const auto answer = [&] { return model.Predict({&query, 1})->at(0).add[{1, 1}]; };
  CHECK(answer() == Approx(0.6));  // both alike
  CHECK(model.identity().name == "auto: nhpm");
  BeliefGrid edited = query.belief;
  edited[{1, 1}] = edited[{1, 2}] = 1.0F;
  model.ReceivedEdits(query, query.belief);  // no edits: (0.1 / 0.7)^2
  CHECK(model.share() == Approx(1.0 / (1.0 + 49.0)));
  CHECK(model.identity().name == "auto: glpf");
  CHECK(answer() == Approx(0.9 / 50 + 0.3 * 49 / 50));
  CHECK(model.PredictEdits(belief, std::vector<ShownView>{{{{1, 1}}, {1, 1}, 0.0, {}}})->at(0) ==
        Approx(ExpectedEdits(model.Predict({&query, 1})->at(0))));
  for (int i = 0; i < 3; ++i) model.ReceivedEdits(query, edited);  // (0.9 / 0.3)^2 each
  CHECK(model.identity().name == "auto: nhpm");
  CHECK(answer() > 0.8F);
  const double share = model.share();
  model.ReceivedEdits(query, BeliefGrid(5, 5));  // another world
  CHECK(model.share() == share);
}

}  // namespace
}  // namespace conav::nhpm
