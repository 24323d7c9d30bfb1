#include "study/gaze/eye_measures.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>

namespace conav::gaze {
namespace {

/// One eye at 100 Hz: 4 mm until 10 s, then 5 mm until 20 s.
EyeRecording StepRecording(int eyes = 1) {
  EyeRecording recording{.name = "P01", .in_mm = true};
  for (int eye = 0; eye < eyes; ++eye) {
    for (int i = 0; i <= 2000; ++i) {
      const double time = i / 100.0;
      recording.pupils.push_back({time, eye, 1.0, (time < 10.0 ? 4.0 : 5.0) * (1.0 + 0.1 * eye)});
    }
  }
  std::ranges::stable_sort(recording.pupils, {}, &PupilSample::time_s);
  return recording;
}

const std::vector<Period> kBaselineAndTrial{{"baseline", 1.0, 9.0, {}}, {"trial", 11.0, 19.0, {}}};

TrialMeasures MeasureOne(const EyeRecording& recording, const AreasOfInterest& areas = {},
                         const std::vector<Period>& periods = kBaselineAndTrial) {
  const auto trials = MeasureTrials(recording, periods, areas, {}, {});
  REQUIRE(trials.size() == 1);
  return trials[0];
}

TEST_CASE("PCPD is the change against the baseline in percent (appendix D.1)", "[study][gaze]") {
  const TrialMeasures one = MeasureOne(StepRecording());
  CHECK(one.baseline == Approx(4.0));
  CHECK(one.diameter_mean == Approx(5.0));
  CHECK(one.pcpd_mean == Approx(25.0));
  CHECK(one.pcpd_sd.value() == Approx(0.0).margin(1e-9));
  CHECK(one.valid_share == Approx(1.0));
  CHECK(one.problem.empty());
  // Each eye against its own baseline: the larger second one changes nothing, even when the first is lost.
  EyeRecording two = StepRecording(2);
  for (PupilSample& sample : two.pupils) {
    if (sample.eye == 0 && sample.time_s > 15.0) sample.confidence = 0.0;
  }
  CHECK(MeasureOne(two).pcpd_mean == Approx(25.0));
  CHECK(MeasureOne(two).diameter_mean == Approx(1.25 * 4.2));
  CHECK(MeasureOne(two).curve.back() == Approx(1.25 * 4.2));
}

TEST_CASE("samples that cannot be pupils do not count", "[study][gaze]") {
  EyeRecording recording = StepRecording();
  const auto sample_at = [&](double time) -> PupilSample& {
    return *std::ranges::find(recording.pupils, time, &PupilSample::time_s);
  };
  SECTION("low confidence") { sample_at(12.0) = {12.0, 0, 0.59, 8.0}; }
  SECTION("no human pupil") {
    sample_at(12.0).diameter = 20.0;
    sample_at(13.0).diameter = 1.0;
  }
  SECTION("too fast: half a mm in 10 ms, where others move by a hundredth") {
    for (std::size_t i = 0; i < recording.pupils.size(); i += 2) {
      recording.pupils[i].diameter += 0.005;
    }
    sample_at(12.0).diameter += 0.5;
    CHECK(MeasureOne(recording).pcpd_mean == Approx(25.0).margin(0.02));
    return;
  }
  SECTION("within a blink") {
    sample_at(12.0).diameter = 6.0;
    recording.blinks = {{11.95, 12.05}};
  }
  const TrialMeasures measures = MeasureOne(recording);
  CHECK(measures.pcpd_mean == Approx(25.0));
  CHECK(measures.valid_share == Approx(1.0));  // short gaps are filled
}

TEST_CASE("long gaps stay empty, with the samples at their edges", "[study][gaze]") {
  EyeRecording recording = StepRecording();
  std::erase_if(recording.pupils, [](const PupilSample& sample) {
    return sample.time_s > 12.0 && sample.time_s < 14.0;
  });
  // 2 s and twice 50 ms of 8 s.
  CHECK(MeasureOne(recording).valid_share == Approx(1.0 - 2.1 / 8.0).margin(0.01));
}

TEST_CASE("a trial whose pupils do not count says why", "[study][gaze]") {
  EyeRecording recording = StepRecording();
  SECTION("no baseline") {
    const TrialMeasures measures = MeasureOne(recording, {}, {{"trial", 11.0, 19.0, {}}});
    CHECK_THAT(measures.problem, Catch::Contains("no baseline"));
    CHECK_FALSE(measures.pcpd_mean);
    CHECK(measures.diameter_mean);
  }
  SECTION("a baseline that goes on is none") {
    const std::vector<Period> periods{{"baseline", 1.0, 12.0, {}}, {"trial", 11.0, 19.0, {}}};
    CHECK_THAT(MeasureOne(recording, {}, periods).problem, Catch::Contains("no baseline"));
  }
  SECTION("a baseline with blinks only") {
    recording.blinks = {{0.0, 10.0}};
    CHECK_THAT(MeasureOne(recording).problem, Catch::Contains("baseline has less than"));
  }
  SECTION("eyes that were hardly seen") {
    recording.blinks = {{11.0, 17.0}};
    CHECK_THAT(MeasureOne(recording).problem, Catch::Contains("% of the trial"));
  }
}

TEST_CASE("blinks count by their beginning, per minute", "[study][gaze]") {
  EyeRecording recording = StepRecording();
  recording.blinks = {{10.9, 11.2}, {12.0, 12.1}, {18.9, 19.2}, {19.0, 19.1}};
  CHECK(MeasureOne(recording).blinks_per_min == Approx(2 / (8.0 / 60.0)));
}

TEST_CASE("what is seen in a pause counts nowhere, nor does its time", "[study][gaze]") {
  EyeRecording recording = StepRecording();
  for (PupilSample& sample : recording.pupils) {
    if (sample.time_s >= 13.0 && sample.time_s < 17.0) sample.diameter = 8.0;
  }
  recording.blinks = {{12.0, 12.01}, {14.0, 14.01}, {18.0, 18.01}};
  recording.surfaces["map"].fixations = {{1, 12.0, 0.4, 0.5, 0.5}, {2, 14.0, 0.4, 0.5, 0.5}};
  std::vector<Period> periods = kBaselineAndTrial;
  periods.push_back({"pause", 13.0, 17.0, {}});
  const TrialMeasures measures = MeasureOne(recording, {}, periods);
  CHECK(measures.observed_s == Approx(4.0));
  CHECK(*measures.pcpd_mean == Approx(25.0).margin(0.5));  // lines to 8 mm at its edges
  CHECK(measures.valid_share > 0.9);
  CHECK(measures.blinks_per_min == Approx(2 / (4.0 / 60.0)));
  CHECK(measures.fixations_per_min.at("map") == Approx(1 / (4.0 / 60.0)));
  CHECK(measures.dwell_share.at("map") == Approx(0.4 / 4.0));
}

TEST_CASE("a shift is a fixation on another area than the one before", "[study][gaze]") {
  EyeRecording recording = StepRecording();
  // The page's y runs up for the tracker and down for the areas.
  const auto look = [&](double time, double x, double y) {
    recording.surfaces["page"].fixations.push_back(
        {static_cast<std::int64_t>(time * 10.0), time, 0.4, x, y});
  };
  const AreasOfInterest areas{
      .layouts = {{0.0, {{"picture", 0.0, 0.0, 0.5, 0.5}, {"map", 0.5, 0.0, 0.5, 1.0}}},
                  {17.0, {{"map", 0.0, 0.0, 0.5, 1.0}}}}};
  look(10.0, 0.6, 0.5);  // before the trial
  look(11.0, 0.1, 0.9);  // picture
  look(12.0, 0.1, 0.9);  // picture
  look(13.0, 0.1, 0.1);  // nothing
  look(14.0, 0.9, 0.9);  // map
  look(15.0, 0.1, 0.6);  // picture
  look(18.8, 0.1, 0.9);  // the map is there now, and the trial ends in the fixation
  const TrialMeasures measures = MeasureOne(recording, areas);
  const double minutes = 8.0 / 60.0;
  CHECK(measures.shifts_per_min == Approx(3 / minutes));
  CHECK(measures.fixations_per_min.at("picture") == Approx(3 / minutes));
  CHECK(measures.fixations_per_min.at("map") == Approx(2 / minutes));
  CHECK(measures.dwell_share.at("picture") == Approx(1.2 / 8.0));
  CHECK(measures.dwell_share.at("map") == Approx(0.6 / 8.0));
}

TEST_CASE("surfaces other than the page are areas themselves", "[study][gaze]") {
  EyeRecording recording = StepRecording();
  recording.surfaces["robot view"].fixations = {{1, 12.0, 0.3, 0.5, 0.5}};
  recording.surfaces["map"].fixations = {{2, 13.0, 0.3, 0.5, 0.5}};
  CHECK(MeasureOne(recording).shifts_per_min == Approx(1 / (8.0 / 60.0)));
  CHECK_FALSE(MeasureOne(StepRecording()).shifts_per_min);
}

TEST_CASE("a curve has 1000 points, smoothed over 5", "[study][gaze]") {
  const std::vector<Period> periods{{"baseline", 1.0, 5.0, {}}, {"trial", 6.0, 14.0, {}}};
  const auto curve = MeasureOne(StepRecording(), {}, periods).curve;
  REQUIRE(curve.size() == kCurvePoints);
  CHECK(curve.front() == Approx(4.0));
  CHECK(curve.back() == Approx(5.0));
  CHECK(curve[300] == Approx(4.0));
  CHECK(curve[700] == Approx(5.0));
}

TEST_CASE("periods are pairs of marks, with the keys of both", "[study][gaze]") {
  std::vector<std::string> problems;
  const auto periods = PeriodsOf({{1.0, "trial begin", {{"method", "teleop"}}},
                                  {2.0, "a note", {}},
                                  {3.0, "trial end", {{"part", "1"}}},
                                  {4.0, "rest end", {}},
                                  {5.0, "trial begin", {}}},
                                 problems);
  REQUIRE(periods.size() == 1);
  CHECK(periods[0].duration_s() == 2.0);
  CHECK(periods[0].Key("method") == "teleop");
  CHECK(periods[0].Key("part") == "1");
  CHECK(periods[0].Key("layout").empty());
  CHECK(problems ==
        std::vector<std::string>{"rest ends without having begun", "trial does not end"});
}

TEST_CASE("a heat map has its first row at the upper edge", "[study][gaze]") {
  EyeRecording recording = StepRecording();
  recording.surfaces["page"].gaze = {{12.0, 0.9, 0.0, 1.0},
                                     {13.0, 0.9, 0.99, 0.01},
                                     {14.0, 0.1, 0.5, 0.5},   // not sure
                                     {25.0, 0.9, 0.5, 0.5}};  // after the trial
  const auto heat = HeatMap(recording, kBaselineAndTrial[1], "page", 0.6);
  CHECK(heat.front() == 1.0);
  CHECK(heat.back() == 1.0);
  CHECK(std::accumulate(heat.begin(), heat.end(), 0.0) == 2.0);
}

}  // namespace
}  // namespace conav::gaze
