#include "nhpm/evaluation/metrics.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "unit/nhpm/evaluation/samples.h"

namespace conav::nhpm {
namespace {

/// Two segments of four outputs; the first was edited twice, the second once.
Outcomes Sample() {
  return MakeOutcomes({{{0.75F, true}, {0.5F, true}, {0.5F, false}, {0.0F, false}},
                       {{0.25F, true}, {0.25F, false}, {0.0F, false}, {0.0F, false}}});
}

TEST_CASE("The cross-entropy of an output is the logarithm of what happened", "[metrics]") {
  CHECK(CrossEntropy(0.25, true) == Approx(std::log(4.0)));
  CHECK(CrossEntropy(0.25, false) == Approx(std::log(4.0 / 3.0)));
  CHECK(CrossEntropy(0.0, false) == Approx(1.0e-7));
  CHECK(CrossEntropy(0.0, true) == Approx(16.118096));  // -ln 1e-7
  CHECK(CrossEntropy(1.0, false) == Approx(16.118096));
}

TEST_CASE("The mean cross-entropy counts masked outputs, or not", "[metrics]") {
  const Loss loss = MeanCrossEntropy(Sample());
  // -ln(.75) - 2 ln(.5) - ln(.25) - ln(.75) = 0.287682 + 1.386294 + 1.386294 + 0.287682
  CHECK(loss.unmasked == Approx(3.347952 / 8).epsilon(1e-6));
  CHECK(loss.all == Approx(3.347952 / 16).epsilon(1e-6));
}

TEST_CASE("IoU divides what is predicted and true by what is predicted or true", "[metrics]") {
  CHECK(IouAt(Sample(), 0.75) == Approx(1.0 / 3.0));
  CHECK(IouAt(Sample(), 0.5) == Approx(2.0 / 4.0));  // the boundary itself is predicted
  CHECK(IouAt(Sample(), 0.25) == Approx(3.0 / 5.0));
  CHECK(IouAt(Sample(), 0.8) == 0.0);
  CHECK(IouAt(MakeOutcomes({{{0.1F, false}}}), 0.5) == 1.0);
}

TEST_CASE("The best boundary is the lowest of the grid with the highest IoU", "[metrics]") {
  const BoundaryIou best = BestIou(Sample());
  CHECK(best.iou == Approx(0.6));
  CHECK(best.boundary == Approx(0.01));  // up to 0.25 nothing changes
  const Outcomes noisy = MakeOutcomes({{{0.315F, true}, {0.305F, false}, {0.302F, false}}});
  CHECK(BestIou(noisy).iou == 1.0);
  CHECK(BestIou(noisy).boundary == Approx(0.31));
}

TEST_CASE("The mean IoU of segments leaves out those with nothing in them", "[metrics]") {
  Outcomes outcomes = Sample();
  CHECK(*SegmentMeanIou(outcomes, 0.25) == Approx((2.0 / 3.0 + 1.0 / 2.0) / 2.0));
  outcomes.values.push_back({0.0F, false});
  outcomes.segment_ends.push_back(outcomes.values.size());
  CHECK(*SegmentMeanIou(outcomes, 0.25) == Approx((2.0 / 3.0 + 1.0 / 2.0) / 2.0));
  CHECK_FALSE(SegmentMeanIou(MakeOutcomes({{{0.1F, false}}}), 0.5));
}

TEST_CASE("Calibration compares promise and share edited bin by bin", "[metrics]") {
  const Calibration calibration = Calibrate(Sample(), 4);
  REQUIRE(calibration.bins.size() == 4);
  // [0, .25): 3 x 0, none edited; [.25, .5): 2 x .25, one edited; [.5, .75): 2 x .5, one edited;
  // [.75, 1]: .75, edited
  CHECK(calibration.bins[0].outputs == 3);
  CHECK(calibration.bins[1].mean_probability == Approx(0.25));
  CHECK(calibration.bins[1].edited_share == Approx(0.5));
  CHECK(calibration.bins[2].edited_share == Approx(0.5));
  CHECK(calibration.bins[3].mean_probability == Approx(0.75));
  CHECK(calibration.error == Approx((2 * 0.25 + 2 * 0.0 + 1 * 0.25) / 8));
  CHECK(Calibrate(MakeOutcomes({{{1.0F, true}}})).bins.back().outputs == 1);
}

TEST_CASE("Edits expected and made are counted segment by segment, in bins of equal size",
          "[metrics]") {
  const EditCounts counts = CompareEditCounts(Sample());
  CHECK(counts.mean_expected == Approx((1.75 + 0.5) / 2));
  CHECK(counts.mean_true == Approx(1.5));
  CHECK(*counts.correlation == Approx(1.0));
  CHECK(counts.bins.size() == 2);  // no more bins than segments
  std::vector<std::vector<Outcome>> segments;
  for (int i = 0; i < 5; ++i) segments.push_back({{0.2F * static_cast<float>(4 - i), i == 0}});
  const auto bins = CompareEditCounts(MakeOutcomes(segments), 2).bins;
  REQUIRE(bins.size() == 2);
  CHECK(bins[0].segments == 2);
  CHECK(bins[0].mean_expected == Approx(0.1));
  CHECK(bins[1].segments == 3);
  CHECK(bins[1].mean_true == Approx(1.0 / 3.0));
}

TEST_CASE("The correlation of edits is Pearson's", "[metrics]") {
  // expected 0, 0.5, 1; true 0, 1, 0: covariance 0; then true 1, 0, 0: -0.866
  const Outcome none{0.0F, false};
  CHECK(*CompareEditCounts(MakeOutcomes({{none}, {{0.5F, true}}, {{1.0F, false}}})).correlation ==
        Approx(0.0).margin(1e-12));
  CHECK(*CompareEditCounts(MakeOutcomes({{{0.0F, true}}, {{0.5F, false}}, {{1.0F, false}}}))
             .correlation == Approx(-std::sqrt(0.75)));
  CHECK_FALSE(CompareEditCounts(MakeOutcomes({{none}, {none}})).correlation);
}

TEST_CASE("Without segments every figure is nothing", "[metrics]") {
  CHECK(PairOutcomes({}, {})->values.empty());
  const Outcomes none;
  CHECK(MeanCrossEntropy(none).all == 0.0);
  CHECK(BestIou(none).iou == 0.0);
  CHECK_FALSE(SegmentMeanIou(none, 0.5));
  CHECK(Calibrate(none).error == 0.0);
  CHECK(CompareEditCounts(none).bins.empty());
}

TEST_CASE("Each cell inside of the border has the output that x leaves open, segment by segment",
          "[outcomes]") {
  std::vector<Segment> segments{EmptySegment(3, 3), EmptySegment(3, 4)};
  Segment& second = segments[1];  // inside: (1,1) and (1,2)
  second.query.belief[{1, 2}] = 1.0F;
  Flip(second, {1, 2});
  std::vector<PerceptionAnswer> answers{ZeroAnswer(segments[0]), ZeroAnswer(second)};
  answers[1].add[{1, 1}] = 0.25F;
  answers[1].remove[{1, 2}] = 0.75F;
  answers[1].add[{1, 2}] = 0.5F;     // masked: there is a wall
  answers[1].remove[{0, 0}] = 0.5F;  // masked: the border
  const auto outcomes = PairOutcomes(Pointers(segments), answers);
  REQUIRE(outcomes);
  CHECK(outcomes->values == std::vector<Outcome>{{0.0F, false}, {0.25F, false}, {0.75F, true}});
  CHECK(outcomes->segment_ends == std::vector<std::size_t>{1, 3});
  CHECK(outcomes->outputs == 18 + 24);
}

TEST_CASE("Answers that do not belong to the segments are refused", "[outcomes]") {
  const std::vector<Segment> segments{EmptySegment(), EmptySegment()};
  std::vector<PerceptionAnswer> answers{ZeroAnswer(segments[0])};
  const auto refusal = [&] { return PairOutcomes(Pointers(segments), answers).error().text; };
  CHECK_THAT(refusal(), Catch::Contains("1 answers"));
  answers.push_back(ZeroAnswer(EmptySegment(4, 4)));
  CHECK_THAT(refusal(), Catch::Contains("segment 1") && Catch::Contains("4 x 4"));
  answers[1] = ZeroAnswer(segments[1]);
  for (const float value : {std::numeric_limits<float>::quiet_NaN(), 1.5F}) {
    answers[1].add[{2, 2}] = value;
    CHECK_THAT(refusal(), Catch::Contains("(2,2)"));
  }
}

}  // namespace
}  // namespace conav::nhpm
