#include "study/waterway.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "support/refusal.h"

namespace conav::study {
namespace {

constexpr double kOpenDrive = 0.0;

/// A crossing that ended at the goal after so many metres.
EpisodeRecord Crossed(const WaterwayTrial& trial, double distance_m) {
  EpisodeRecord record{.name = trial.name(), .status = EpisodeStatus::kComplete};
  record.measures = EpisodeMeasures{.images = 2.0,
                                    .distance_m = distance_m,
                                    .mapping_accuracy_after = 0.5,
                                    .decision_ms_p95 = 100.0 + distance_m};
  return record;
}

TEST_CASE("the shortest drive goes around walls, keeps its distance, and ends near the goal",
          "[waterway]") {
  const OccupancyGrid open(21, 21, Occupancy::kFree);
  CHECK(ShortestDrive(open, {10, 2}, {10, 18}, kOpenDrive, 0.0) == Approx(16.0));
  CHECK(ShortestDrive(open, {10, 2}, {10, 18}, kOpenDrive, 3.0) == Approx(13.0));
  // A direction that none of the legs has costs less than one percent.
  const double slanted = std::hypot(7.0, 16.0);
  const double found = ShortestDrive(open, {10, 2}, {17, 18}, kOpenDrive, 0.0);
  CHECK(found >= slanted - 1e-9);
  CHECK(found <= 1.01 * slanted);

  OccupancyGrid walled = open;  // a wall with a gap of five cells at the southern end
  for (int row = 0; row < 16; ++row) walled[{row, 10}] = Occupancy::kOccupied;
  const double around = 2.0 * std::hypot(8.0, 6.0);
  CHECK(ShortestDrive(walled, {10, 2}, {10, 18}, kOpenDrive, 0.0) == Approx(around).epsilon(0.02));
  // A wide robot goes farther south, a wider one does not come through.
  CHECK(ShortestDrive(walled, {10, 2}, {10, 18}, 3.0, 0.0) > around + 1.0);
  for (int column = 0; column < 21; ++column) walled[{20, column}] = Occupancy::kOccupied;
  CHECK(ShortestDrive(walled, {10, 2}, {10, 18}, 2.0, 0.0) < 40.0);
  CHECK(std::isinf(ShortestDrive(walled, {10, 2}, {10, 18}, 3.0, 0.0)));
}

TEST_CASE("a study of waterways compares the ways of driving on each map", "[waterway]") {
  WaterwayOptions options;
  options.seeds = 5;
  CHECK(TrialsOf(options).size() == 15);
  WaterwayRecords records;
  std::map<std::uint64_t, double> optima;
  for (const WaterwayTrial& trial : TrialsOf(options)) {
    optima[trial.seed] = 100.0;
    const double metres = trial.crossing == Crossing::kGreedy   ? 150.0
                          : trial.crossing == Crossing::kGuided ? 110.0 + double(trial.seed)
                                                                : 140.0;
    records[trial.name()] = Crossed(trial, metres);
  }
  records["seed002-greedy"].status = EpisodeStatus::kGoalsLeft;      // longer than any
  records["seed003-ig-mcts"].measures->distance_m = 160.0;           // longer than greedy
  records["seed004-ig-mcts-alone"].status = EpisodeStatus::kFailed;  // nothing was measured
  records["seed004-ig-mcts-alone"].measures.reset();

  const WaterwaySummary summary = Summarise(options, records, optima);
  REQUIRE(summary.crossings.size() == 3);
  const CrossingSummary& guided = summary.crossings[1];
  CHECK(guided.reached == 5);
  CHECK(guided.path_over_optimum_median == Approx(1.14));
  CHECK(guided.path_over_optimum_worst == Approx(1.6));
  CHECK(guided.decision_ms_p95 == Approx(215.0));
  CHECK(summary.crossings[0].reached == 4);
  CHECK(std::isinf(summary.crossings[0].path_over_optimum_worst));
  CHECK(summary.shorter_than_greedy_fraction == Approx(0.8));
  CHECK(summary.failed == std::vector<std::string>{"seed004-ig-mcts-alone"});
  for (const WaterwayBar& bar : BarsOf(summary)) CHECK(bar.met());

  const auto json = WaterwayJson(summary, DesignOf(options));
  CHECK(json["waterway"]["reached_fraction"] == 1.0);
  CHECK(json["waterway"]["path_over_optimum_median"].get<double>() == Approx(1.14));
  CHECK(json["waterway"]["shorter_than_greedy_fraction"].get<double>() == Approx(0.8));
  CHECK(json["waterway"]["decision_p95_ms"].get<double>() == Approx(215.0));
  CHECK(json["crossings"][0]["path_over_optimum_worst"].is_null());
  CHECK_THAT(WaterwayText(summary), Catch::Contains("not reached") && Catch::Contains("4 of 5"));
  CHECK_THAT(WaterwayCsv(options, records, optima),
             Catch::Contains("2,greedy,goals left,150.00,100.00"));

  records["seed001-ig-mcts"].status = EpisodeStatus::kGoalsLeft;
  CHECK_FALSE(BarsOf(Summarise(options, records, optima)).front().met());
}

TEST_CASE("options of a study of waterways that cannot be are refused by name", "[waterway]") {
  WaterwayOptions options;
  options.seeds = 0;
  test::CheckRefusal(Validate(options), Catch::Contains("--seeds 0"));
  options = {.seeds = 1, .jobs = 1000};
  test::CheckRefusal(Validate(options), Catch::Contains("--jobs 1000"));
  options = {.seeds = 1, .camera = "film"};
  test::CheckRefusal(Validate(options), Catch::Contains("--camera film"));
}

}  // namespace
}  // namespace conav::study
