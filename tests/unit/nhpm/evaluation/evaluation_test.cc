#include "nhpm/evaluation/evaluation.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "common/segments/segment.h"
#include "unit/nhpm/evaluation/samples.h"

namespace conav::nhpm {
namespace {

TEST_CASE("A model is measured on both parts of the data, where there are two", "[evaluation]") {
  EvaluationData data = SampleData();
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
  data.train = {};
  const auto untrained = EvaluateModel({"even", "Even", ""}, even, data);
  REQUIRE(untrained);
  CHECK_FALSE(untrained->train);
  CHECK_FALSE(untrained->at_train_boundary);
}

TEST_CASE("GLPF-Test bounds GLPF-Train, and both find the people who are a GLPF", "[evaluation]") {
  const EvaluationData data = SampleData();
  const auto train = EvaluateGlpfTrain(data);
  const auto test = EvaluateGlpfTest(data);
  REQUIRE(train);
  REQUIRE(test);
  CHECK(test->test.loss.all < train->test.loss.all);
  CHECK(train->test.loss.all < 1.1 * test->test.loss.all);
  CHECK(train->train.has_value());
  CHECK_FALSE(test->train.has_value());
  CHECK(test->test.boundary_source == BoundarySource::kTest);
  CHECK(train->label.key == "glpf_train");
  CHECK_THAT(test->label.about, Catch::Contains("alpha_d"));
  // GLPF-Train's boundary is ideal on the train part, its IoU that of the test part.
  Glpf model(FitGlpf(CountStimuli(AllSegments(data.train))).best.parameters);
  std::vector<std::size_t> reported;
  const auto answers = AskModel(model, data.train, [&](std::size_t done, std::size_t all) {
    reported.push_back(done);
    CHECK(all == 120);
  });
  CHECK(reported == std::vector<std::size_t>{64, 120});
  const auto on_train = PairOutcomes(AllSegments(data.train), *answers);
  const auto on_test = PairOutcomes(AllSegments(data.test), train->answers);
  CHECK(train->test.best.boundary == BestIou(*on_train).boundary);
  CHECK(train->test.best.iou == IouAt(*on_test, train->test.best.boundary));
}

TEST_CASE("Answers of another number than the segments name the row", "[evaluation]") {
  const auto none = EvaluateAnswers({"oracle", "Oracle", ""}, {}, {}, SampleData());
  REQUIRE_FALSE(none);
  CHECK_THAT(none.error().text, Catch::StartsWith("Oracle: 0 answers"));
}

/// A row with a loss in each segment of two trajectories of two segments.
ModelRow RowWith(const std::string& key, const std::vector<double>& losses, double iou) {
  ModelRow row;
  row.label = {key, key, ""};
  row.segment_losses = losses;
  for (const double loss : losses) row.test.loss.all += loss / 100.0;
  row.test.best = {0.5, iou};
  return row;
}

EvaluationData TwoTrajectories() {
  EvaluationData data;
  EvenModel even(0.0F);
  data.test = SegmentsOf(even, 2, 2, 1);
  return data;
}

TEST_CASE(
    "The excess share lies between oracle and baseline, and a bar is passed at its limit, one "
    "from below only above it",
    "[bars]") {
  CHECK(ExcessShare(2.0, 2.0, 4.0) == 0.0);
  CHECK(ExcessShare(2.5, 2.0, 4.0) == 0.25);
  CHECK(ExcessShare(4.0, 2.0, 4.0) == 1.0);
  CHECK(std::isinf(ExcessShare(2.0, 2.0, 2.0)));
  CHECK(Bar{.value = 0.2, .limit = 0.2}.passed());
  CHECK_FALSE(Bar{.value = 0.21, .limit = 0.2}.passed());
  CHECK(Bar{.value = 0.21, .limit = 0.2, .at_most = false}.passed());
  CHECK_FALSE(Bar{.value = 0.2, .limit = 0.2, .at_most = false}.passed());
}

TEST_CASE("NHPM is measured against the oracle and both GLPFs", "[bars]") {
  std::vector<ModelRow> rows{RowWith("glpf_train", {3.0, 3.0, 3.0, 3.0}, 0.4),
                             RowWith("glpf_test", {2.0, 2.0, 2.0, 2.0}, 0.3),
                             RowWith("nhpm", {1.2, 1.2, 1.1, 1.1}, 0.35),
                             RowWith("oracle", {1.0, 1.0, 1.0, 1.0}, 0.5)};
  rows[0].test.boundary_source = BoundarySource::kTrain;
  rows[2].at_train_boundary = {0.4, 0.41};
  const auto bars = CheckBars(TwoTrajectories(), rows);
  REQUIRE(bars.size() == 3);
  CHECK(bars[0].key == "excess_share");
  CHECK(bars[0].value == Approx(0.15));
  CHECK(bars[0].passed());
  CHECK(bars[1].key == "iou_above_glpf_train");
  CHECK(bars[1].value == 0.41);  // as GLPF-Train's, at a boundary of the train part
  CHECK_THAT(bars[1].text, Catch::Contains("train part"));
  CHECK(bars[1].passed());
  CHECK(bars[2].value == 0.35);
  CHECK_THAT(bars[2].text, Catch::Contains("test part"));
  CHECK(bars[2].passed());
  // Only those that the rows allow to say, and none of people.
  CHECK(CheckBars(TwoTrajectories(), {rows[1]}).empty());
  CHECK(CheckBars(TwoTrajectories(), {rows[2]}).empty());
  CHECK(CheckBars(TwoTrajectories(), {rows[2], rows[1]}).size() == 1);
  EvaluationData people = TwoTrajectories();
  people.test.trajectories[0].origin = SegmentOrigin::kPerson;
  CHECK(CheckBars(people, rows).empty());
}

TEST_CASE("The interval holds the shares of the trajectories", "[bars]") {
  const ModelRow oracle = RowWith("oracle", {1.0, 1.0, 1.0, 1.0}, 0.5);
  const ModelRow glpf = RowWith("glpf_test", {2.0, 2.0, 2.0, 2.0}, 0.5);
  const ModelRow nhpm = RowWith("nhpm", {1.2, 1.2, 1.1, 1.1}, 0.5);
  const auto interval = ExcessShareInterval(TwoTrajectories(), nhpm, oracle, glpf);
  REQUIRE(interval);
  CHECK(interval->low == Approx(0.1));  // the second trajectory twice
  CHECK(interval->high == Approx(0.2));
  EvaluationData one = TwoTrajectories();
  one.test.trajectories.pop_back();
  CHECK_FALSE(ExcessShareInterval(one, nhpm, oracle, glpf));
}

}  // namespace
}  // namespace conav::nhpm
