#include "nhpm/model/encoder_decoder_model.h"

#include <catch2/catch.hpp>
#include <memory>
#include <thread>

#include "common/runtime/random.h"
#include "conformance/perception_model_conformance.h"
#include "nhpm/model/load_model.h"
#include "support/refusal.h"
#include "support/test_weights.h"

namespace conav::nhpm {
namespace {

using planner::conformance::MakeQuery;

TEST_CASE("Answers are the masked probabilities of the pass", "[encoder-decoder]") {
  const NetworkModel model = test::UntrainedEncoderDecoder(3);
  const PerceptionQuery query = MakeQuery(4, 21, 30);
  std::vector<float> input(query.belief.size() * kInputChannels);
  EncodeInput(query, {}, input, kRasterDepthRange);
  EncoderDecoderPass pass(model.weights.shape, 21, 30, EncoderDecoderPass::Use::kInference);
  pass.SetWeights(std::make_shared<const NetworkWeights>(model.weights));
  const auto answers = EncoderDecoderModel(model).Predict({&query, 1});
  REQUIRE(answers);
  CHECK((answers->front() == MaskedAnswer(query.belief, pass.Forward(input))));
}

TEST_CASE("Sizes may change within a batch, threads and batches do not change the bits",
          "[encoder-decoder]") {
  EncoderDecoderModel model(test::UntrainedEncoderDecoder(5));
  std::vector<PerceptionQuery> queries;
  for (std::uint64_t i = 0; i < 8; ++i) queries.push_back(MakeQuery(i, i % 3 == 0 ? 9 : 14));
  const auto expected = model.Predict(queries);
  REQUIRE(expected);
  std::vector<std::thread> threads;
  std::vector<Result<std::vector<PerceptionAnswer>>> answers(queries.size());
  for (std::size_t i = 0; i < queries.size(); ++i) {
    threads.emplace_back([&, i] { answers[i] = model.Predict({&queries[i], 1}); });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < queries.size(); ++i) {
    CAPTURE(i);
    REQUIRE(answers[i]);
    CHECK((answers[i]->front() == (*expected)[i]));
  }
}

/// What a view from a robot's place of a raster shows: a square in front of it, and the way there.
ShownView ViewIn(int rows, int columns, Random& random) {
  const auto below = [&](int most) { return static_cast<int>(random.Uniform(0, most - 1)); };
  ShownView view{.cell = {below(rows), below(columns)}, .heading_rad = random.Unit()};
  for (int i = 0; i < 60; ++i) {
    const Cell cell{std::min(view.cell.row + i / 8, rows - 1),
                    std::min(view.cell.column + i % 8, columns - 1)};
    (i % 5 == 0 ? view.visible.walls : view.visible.free).push_back(cell);
    if (i < 9) view.path.push_back(cell);
  }
  return view;
}

TEST_CASE("Expected edits by windows have the bits of whole passes, as map and path change",
          "[encoder-decoder]") {
  const auto [rows, columns] = GENERATE(table<int, int>({{21, 30}, {203, 330}, {400, 121}}));
  EncoderDecoderModel model(test::UntrainedEncoderDecoder(7));
  Random random(8);
  BeliefGrid belief(rows, columns, 0.0F);
  for (float& value : belief.values()) value = random.Chance(0.2) ? 1.0F : 0.0F;
  for (int change = 0; change < 3; ++change) {
    for (int i = 0; i < 5; ++i)
      belief[{rows / 2 + i, columns / 3}] = 0.25F * static_cast<float>(change);
    const auto shared = std::make_shared<const BeliefGrid>(belief);
    std::vector<ShownView> views;
    for (int i = 0; i < 3; ++i) views.push_back(ViewIn(rows, columns, random));
    const auto whole = model.PerceptionModel::PredictEdits(shared, views);
    REQUIRE(whole);
    CHECK(model.PredictEdits(shared, views).value() == *whole);
    for (std::size_t i = 0; i < views.size(); ++i) {
      CAPTURE(change, i);
      CHECK(model.PredictEdits(shared, {&views[i], 1}).value().front() == (*whole)[i]);
    }
  }
  const auto shared = std::make_shared<const BeliefGrid>(belief);
  const std::vector<ShownView> views{ViewIn(rows, columns, random), ViewIn(rows, columns, random)};
  const auto expected = model.PredictEdits(shared, views).value();
  std::vector<std::vector<double>> found(3);
  std::vector<std::thread> threads;
  for (auto& edits : found) {
    threads.emplace_back([&] {
      for (int i = 0; i < 3; ++i) edits = model.PredictEdits(shared, views).value();
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const auto& edits : found) CHECK(edits == expected);
  ShownView outside = ViewIn(rows, columns, random);
  outside.cell = {rows, 0};
  CHECK_FALSE(model.PredictEdits(std::make_shared<const BeliefGrid>(belief), {&outside, 1}));
}

TEST_CASE("Weights that overflow are an error", "[encoder-decoder]") {
  NetworkModel large = test::UntrainedEncoderDecoder(5);
  for (const std::size_t layer : {11U, 12U}) {
    for (float& value : large.weights.weights[layer]) value *= 1e30F;
  }
  const PerceptionQuery query = MakeQuery(1);
  test::CheckRefusal(EncoderDecoderModel(large).Predict({&query, 1}),
                     Catch::Contains("encoder-decoder"), ErrorCode::kOutOfRange);
  const ShownView view{.path = {}, .cell = query.cell};
  test::CheckRefusal(EncoderDecoderModel(large).PredictEdits(
                         std::make_shared<const BeliefGrid>(query.belief), {&view, 1}),
                     Catch::Contains("encoder-decoder"), ErrorCode::kOutOfRange);
}

TEST_CASE("A weights file only serves its own kind of model", "[encoder-decoder]") {
  const test::WeightsFolder folder;
  const std::string mazes = folder.Write("mazes", test::UntrainedNetwork(1));
  const std::string rasters = folder.Write("rasters", test::UntrainedEncoderDecoder(1));
  using enum PerceptionModelKind;
  CHECK(LoadPerceptionModel(kEncoderDecoder, rasters, {}).value()->identity().name ==
        Name(kEncoderDecoder));
  for (const auto& [kind, file] : {std::pair(kNhpm, rasters), std::pair(kEncoderDecoder, mazes)}) {
    const auto loaded = LoadPerceptionModel(kind, file, {});
    test::CheckRefusal(loaded, Catch::Contains(file) && Catch::Contains(std::string(Name(kind))),
                       ErrorCode::kInvalidArgument);
  }
}

}  // namespace
}  // namespace conav::nhpm
