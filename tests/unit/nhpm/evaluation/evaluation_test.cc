#include "nhpm/evaluation/evaluation.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "common/segments/segment.h"
#include "unit/nhpm/evaluation/evaluation_samples.h"

namespace conav::nhpm {
namespace {

/// Answers nothing but an error.
class RefusingModel final : public PerceptionModel {
 public:
  Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> /*queries*/) override {
    return Fail(ErrorCode::kInvalidArgument, "made for 13 x 13 cells, not 9 x 9");
  }
  ModelIdentity identity() const override { return {}; }
};

TEST_CASE("A model is measured on both parts of the data", "[nhpm][evaluation]") {
  const EvaluationData data = SampleData();
  EvenModel even(0.25F);
  const auto row = EvaluateModel({"even", "Even", "0.25 everywhere"}, even, data);
  REQUIRE(row);
  CHECK(row->answers.size() == 40);
  CHECK(row->identity.name == "even");
  // every unmasked output is promised 0.25; e of n were edited
  const double edited = row->test.edits.mean_true / 49.0;  // 7 x 7 cells inside of the border
  CHECK(row->test.loss.unmasked ==
        Approx(edited * std::log(4.0) + (1.0 - edited) * std::log(4.0 / 3.0)));
  CHECK(row->test.loss.all == Approx(row->test.loss.unmasked * 49.0 / 162.0));
  CHECK(row->test.edits.mean_expected == Approx(49 * 0.25));
  CHECK(row->test.best.iou == Approx(edited));
  REQUIRE(row->train);
  CHECK(row->train->unmasked != row->test.loss.unmasked);
  REQUIRE(row->at_train_boundary);
  CHECK(row->at_train_boundary->iou == Approx(edited));  // all or nothing is predicted
  CHECK(std::accumulate(row->segment_losses.begin(), row->segment_losses.end(), 0.0) ==
        Approx(row->test.loss.all * 40 * 162));
}

TEST_CASE("Progress is told until all segments are answered", "[nhpm][evaluation]") {
  const EvaluationData data = SampleData();
  std::vector<std::size_t> told;
  EvenModel even(0.5F);
  const auto answers = AskModel(even, data.train, [&](std::size_t done, std::size_t all) {
    told.push_back(done);
    CHECK(all == 120);
  });
  REQUIRE(answers);
  CHECK(told == std::vector<std::size_t>{64, 120});
}

TEST_CASE("Without a train part there is no loss on it", "[nhpm][evaluation]") {
  EvaluationData data = SampleData();
  data.train = {};
  EvenModel even(0.25F);
  const auto row = EvaluateModel({"even", "Even", ""}, even, data);
  REQUIRE(row);
  CHECK_FALSE(row->train);
  CHECK_FALSE(row->at_train_boundary);
}

TEST_CASE("GLPF-Test bounds GLPF-Train, and both find the people who are a GLPF",
          "[nhpm][evaluation]") {
  const EvaluationData data = SampleData();
  const auto train = EvaluateGlpfTrain(data);
  const auto test = EvaluateGlpfTest(data);
  REQUIRE(train);
  REQUIRE(test);
  CHECK(test->test.loss.all < train->test.loss.all);
  CHECK(train->test.loss.all < 1.1 * test->test.loss.all);
  CHECK(train->train.has_value());
  CHECK_FALSE(test->train.has_value());
  CHECK(train->test.boundary_source == BoundarySource::kTrain);
  CHECK(test->test.boundary_source == BoundarySource::kTest);
  CHECK(train->label.key == "glpf_train");
  CHECK_THAT(test->label.about, Catch::Contains("alpha_d"));
}

TEST_CASE("GLPF-Train's boundary is ideal on the train part, its IoU that of the test part",
          "[nhpm][evaluation]") {
  const EvaluationData data = SampleData();
  const auto row = EvaluateGlpfTrain(data);
  REQUIRE(row);
  const GlpfFit fit = FitGlpf(CountStimuli(AllSegments(data.train)));
  Glpf model(fit.best.parameters);
  const auto on_train = PairOutcomes(AllSegments(data.train), *AskModel(model, data.train, {}));
  const auto on_test = PairOutcomes(AllSegments(data.test), row->answers);
  CHECK(row->test.best.boundary == BestIou(*on_train).boundary);
  CHECK(row->test.best.iou == IouAt(*on_test, row->test.best.boundary));
}

TEST_CASE("A model that refuses is told as it says", "[nhpm][evaluation]") {
  RefusingModel refusing;
  const auto row = EvaluateModel({"nhpm", "NHPM", ""}, refusing, SampleData());
  REQUIRE_FALSE(row);
  CHECK(row.error().text == "made for 13 x 13 cells, not 9 x 9");
}

TEST_CASE("Answers of another number are refused with the row's name", "[nhpm][evaluation]") {
  const auto row = EvaluateAnswers({"oracle", "Oracle", ""}, {}, {}, SampleData());
  REQUIRE_FALSE(row);
  CHECK(row.error().text == "Oracle: 0 answers to 40 segments");
}

}  // namespace
}  // namespace conav::nhpm
