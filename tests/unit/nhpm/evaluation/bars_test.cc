#include <catch2/catch.hpp>
#include <cmath>

#include "nhpm/evaluation/evaluation.h"
#include "unit/nhpm/evaluation/evaluation_samples.h"

namespace conav::nhpm {
namespace {

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
  data.test = SegmentsOf(EvenModel(0.0F), 2, 2, 1);
  return data;
}

TEST_CASE("The excess share lies between oracle and baseline", "[nhpm][bars]") {
  CHECK(ExcessShare(2.0, 2.0, 4.0) == 0.0);
  CHECK(ExcessShare(2.5, 2.0, 4.0) == 0.25);
  CHECK(ExcessShare(4.0, 2.0, 4.0) == 1.0);
  CHECK(std::isinf(ExcessShare(2.0, 2.0, 2.0)));
}

TEST_CASE("A bar is passed at its limit, one from below only above it", "[nhpm][bars]") {
  Bar bar{.value = 0.2, .limit = 0.2};
  CHECK(bar.passed());
  bar.value = 0.21;
  CHECK_FALSE(bar.passed());
  bar.at_most = false;
  CHECK(bar.passed());
  bar.value = 0.2;
  CHECK_FALSE(bar.passed());
}

TEST_CASE("NHPM is measured against the oracle and both GLPFs", "[nhpm][bars]") {
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
  CHECK_THAT(bars[1].text, Catch::EndsWith("best on the train part"));
  CHECK(bars[1].passed());
  CHECK(bars[2].value == 0.35);
  CHECK_THAT(bars[2].text, Catch::EndsWith("best on the test part"));
  CHECK(bars[2].passed());
}

TEST_CASE("The interval holds the shares of the trajectories", "[nhpm][bars]") {
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

TEST_CASE("Bars are only those that the rows allow to say", "[nhpm][bars]") {
  const ModelRow nhpm = RowWith("nhpm", {1.0, 1.0, 1.0, 1.0}, 0.5);
  const ModelRow glpf = RowWith("glpf_test", {2.0, 2.0, 2.0, 2.0}, 0.4);
  CHECK(CheckBars(TwoTrajectories(), {glpf}).empty());
  CHECK(CheckBars(TwoTrajectories(), {nhpm}).empty());
  CHECK(CheckBars(TwoTrajectories(), {nhpm, glpf}).size() == 1);
  EvaluationData people = TwoTrajectories();
  people.test.trajectories[0].origin = SegmentOrigin::kPerson;
  CHECK(CheckBars(people, {nhpm, glpf}).empty());
}

}  // namespace
}  // namespace conav::nhpm
