#include "nhpm/model/perception_network.h"

#include <catch2/catch.hpp>

#include "conformance/perception_model_conformance.h"
#include "nhpm/engine/inference_pass.h"
#include "support/refusal.h"
#include "support/test_weights.h"

namespace conav::nhpm {
namespace {

using planner::conformance::MakeQueries;
using planner::conformance::MakeQuery;

/// The same without bases: each query whole, one value after the other.
std::vector<PerceptionAnswer> Reference(const NetworkModel& model,
                                        const std::vector<PerceptionQuery>& queries) {
  const auto weights =
      std::make_shared<const PackedWeights>(model.weights, PackedWeights::Use::kInference);
  std::vector<PerceptionAnswer> answers;
  for (const PerceptionQuery& query : queries) {
    std::vector<float> input(query.belief.size() * kInputChannels);
    EncodeInput(query, model.inputs, input);
    InferencePass pass(weights, KernelsFor(16), query.belief.rows(), query.belief.columns());
    answers.push_back(MaskedAnswer(query.belief, pass.Full(input)));
  }
  return answers;
}

/// As a planner asks: one belief, a path that grows, views from its ends.
std::vector<PerceptionQuery> PlannerQueries() {
  std::vector<PerceptionQuery> queries;
  for (int belief = 0; belief < 4; ++belief) {
    const PerceptionQuery base = MakeQuery(static_cast<std::uint64_t>(belief));
    for (int i = 0; i < 12; ++i) {
      PerceptionQuery query = base;
      query.visible = MakeQuery(static_cast<std::uint64_t>(100 + i)).visible;
      for (int column = 1; column < 1 + i % 5; ++column) query.path.push_back({1, column});
      if (i % 3 == 2) query.belief[{2, 2 + i % 4}] = 0.5F;
      queries.push_back(query);
    }
  }
  queries.insert(queries.begin() + 7, MakeQuery(2, 6, 7));  // beliefs of several sizes in one batch
  return queries;
}

TEST_CASE("a planner's queries get the bits of whole passes, whatever was asked before",
          "[network]") {
  const NetworkModel model = test::UntrainedNetwork(3);
  PerceptionNetwork network(model);
  std::vector<PerceptionQuery> queries = PlannerQueries();
  const auto expected = Reference(model, queries);
  CHECK(*network.Predict(queries) == expected);
  std::reverse(queries.begin(), queries.end());
  const auto answers = network.Predict(queries);
  REQUIRE(answers);
  CHECK(std::equal(answers->rbegin(), answers->rend(), expected.begin(), expected.end()));
}

TEST_CASE("edits cost what changes can reach: the same bits along an episode, one whole pass",
          "[network]") {
  NetworkModel model = test::UntrainedNetwork(3);
  model.inputs.belief = GENERATE(true, false);
  model.inputs.depth = model.inputs.belief;
  const auto [rows, columns] = GENERATE(table<int, int>({{9, 11}, {103, 98}}));
  PerceptionNetwork network(model);
  PerceptionQuery query = MakeQuery(7, rows, columns);
  const auto cell_at = [rows = rows, columns = columns](int step) {
    return Cell{step * 38 % rows, step * 53 % columns};  // all over the map, its edges included
  };
  for (int step = 0; step < 40; ++step) {
    const auto belief = std::make_shared<const BeliefGrid>(query.belief);
    query.path.push_back(cell_at(step));
    query.visible = MakeQuery(static_cast<std::uint64_t>(100 + step), rows, columns).visible;
    const ShownView view{query.path, query.cell, query.heading_rad, query.visible};
    const auto edits = network.PredictEdits(belief, {&view, 1});
    REQUIRE(edits);
    CHECK(edits->front() == ExpectedEdits(Reference(model, {query}).front()));
    if (step % 5 == 4) query.belief[cell_at(step)] = 0.75F;
    if (step == 20) query.path = {query.cell};                 // a picture was sent
    if (step % 7 == 0) REQUIRE(network.Predict({&query, 1}));  // of the same memory
  }
  CHECK(network.whole_passes() == 1);
}

TEST_CASE("weights for one grid size refuse another by name", "[network]") {
  NetworkModel model = test::UntrainedNetwork(3);
  model.rows = 9;
  model.columns = 11;
  PerceptionNetwork network(model);
  CHECK(network.Predict(MakeQueries(2)));
  test::CheckRefusal(network.Predict(std::vector{MakeQuery(1, 7, 8)}),
                     Catch::Contains("7 x 8") && Catch::Contains("9 x 11"),
                     ErrorCode::kUnavailable);
}

TEST_CASE("finite weights that overflow are refused, not answered", "[network]") {
  NetworkModel model = test::UntrainedNetwork(3);
  std::vector<float>& last = model.weights.weights.back();
  for (std::size_t i = 0; i < last.size(); ++i) last[i] = i % 3 == 0 ? -3e38F : 3e38F;
  test::CheckRefusal(PerceptionNetwork(model).Predict(MakeQueries(1)),
                     Catch::Contains("model nhpm"), ErrorCode::kOutOfRange);
}

TEST_CASE("memory for the newest grid is kept, that for others is bounded", "[network]") {
  PerceptionNetwork network(test::UntrainedNetwork(3));
  CHECK(network.idle_bytes() == 0);
  for (int rows = 300; rows < 330; ++rows) {
    REQUIRE(network.Predict(std::vector{MakeQuery(1, rows, 200)}));
  }
  CHECK(network.idle_bytes() <= PerceptionNetwork::kIdleBytes);
  CHECK(network.idle_bytes() > PerceptionNetwork::kIdleBytes / 2);
  const PerceptionQuery large = MakeQuery(1, 900, 900);
  for (const std::uint64_t passes : {31, 32, 32}) {  // the second makes it the base
    REQUIRE(network.Predict({&large, 1}));
    CHECK(network.whole_passes() == passes);
  }
  CHECK(network.idle_bytes() > PerceptionNetwork::kIdleBytes);
  REQUIRE(network.Predict(MakeQueries(2)));
  CHECK(network.idle_bytes() < PerceptionNetwork::kIdleBytes / 2);
}

}  // namespace
}  // namespace conav::nhpm
