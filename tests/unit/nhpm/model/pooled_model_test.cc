#include "nhpm/model/pooled_model.h"

#include <catch2/catch.hpp>
#include <cmath>

namespace conav::nhpm {
namespace {

/// Expects an edit of each cell with one probability, or fails.
class EvenModel final : public PerceptionModel {
 public:
  EvenModel(std::string name, float probability)
      : name(std::move(name)), probability_(probability) {}
  Result<std::vector<PerceptionAnswer>> Predict(std::span<const PerceptionQuery> queries) override {
    if (fails) return Fail(ErrorCode::kUnavailable, "gone");
    return std::vector<PerceptionAnswer>(
        queries.size(), PerceptionAnswer{Grid<float>(3, 4, probability_), Grid<float>(3, 4)});
  }
  ModelIdentity identity() const override { return {name, "7", "ab"}; }

  std::string name;
  bool fails = false;

 private:
  float probability_;
};

struct Pool {
  std::shared_ptr<EvenModel> first = std::make_shared<EvenModel>("nhpm", 0.9F);
  std::shared_ptr<EvenModel> second = std::make_shared<EvenModel>("glpf", 0.3F);
  PooledPerceptionModel model{first, second};
  PerceptionQuery query{.belief = BeliefGrid(3, 4)};

  float Answer() { return model.Predict({&query, 1})->at(0).add[{1, 1}]; }
};

TEST_CASE("Two models are averaged, and the one that knows this person takes over",
          "[nhpm][model]") {
  Pool pool;
  const auto odds = [](double p) { return p / (1.0 - p); };
  const double even = std::sqrt(odds(0.9) * odds(0.3));
  CHECK(pool.Answer() == Approx(even / (1.0 + even)));
  CHECK(pool.model.Predict({&pool.query, 1})->at(0).remove[{1, 1}] == 0.0F);  // masked
  CHECK(pool.model.identity() == ModelIdentity{"auto: 50 % nhpm, 50 % glpf", "7", ""});
  pool.model.ReceivedEdits(pool.query, pool.query.belief);  // nothing in two cells
  const double lead = 2.0 * std::log(0.7 / 0.1);
  CHECK(pool.model.second_weight() == std::round(100.0 / (1.0 + std::exp(-lead))) / 100.0);
  CHECK(pool.model.identity().name == "auto: 2 % nhpm, 98 % glpf");
  const double other = std::pow(odds(0.9), 0.02) * std::pow(odds(0.3), 0.98);
  CHECK(pool.Answer() == Approx(other / (1.0 + other)));

  BeliefGrid edited = pool.query.belief;
  edited[{1, 1}] = edited[{1, 2}] = 1.0F;
  pool.model.ReceivedEdits(pool.query, edited);
  const double after = PooledPerceptionModel::kMemory * lead + 2.0 * std::log(0.3 / 0.9);
  CHECK(pool.model.second_weight() == Approx(1.0 / (1.0 + std::exp(-after))).margin(0.005));

  const double weight = pool.model.second_weight();
  pool.model.ReceivedEdits(pool.query, BeliefGrid(5, 5));  // another world
  CHECK(pool.model.second_weight() == weight);

  pool.first->name = "fallback: glpf";  // whose predictions nobody has compared yet
  pool.model.ReceivedEdits(pool.query, pool.query.belief);
  CHECK(pool.model.second_weight() == std::round(100.0 / (1.0 + std::exp(-lead))) / 100.0);
}

TEST_CASE("A pool needs both of its models", "[nhpm][model]") {
  Pool pool;
  for (EvenModel* gone : {pool.first.get(), pool.second.get()}) {
    gone->fails = true;
    CHECK(pool.model.Predict({&pool.query, 1}).error().code == ErrorCode::kUnavailable);
    pool.model.ReceivedEdits(pool.query, pool.query.belief);
    CHECK(pool.model.second_weight() == 0.5);
    gone->fails = false;
  }
}

}  // namespace
}  // namespace conav::nhpm
