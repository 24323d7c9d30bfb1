#include "study/waterway.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "support/refusal.h"

namespace conav::study {
namespace {

/// A crossing that ended at the goal after so many metres; 100 would have done.
EpisodeRecord Crossed(const WaterwayTrial& trial, double distance_m) {
  EpisodeRecord record{.name = trial.name(), .status = EpisodeStatus::kComplete};
  record.measures = EpisodeMeasures{.images = 2.0,
                                    .distance_m = distance_m,
                                    .optimal_distance_m = 100.0,
                                    .mapping_accuracy_after = 0.5,
                                    .decision_ms_p95 = 100.0 + distance_m};
  return record;
}

TEST_CASE("a study of waterways compares the ways of driving on each map", "[waterway]") {
  WaterwayOptions options;
  options.seeds = 5;
  CHECK(TrialsOf(options).size() == 15);
  WaterwayRecords records;
  for (const WaterwayTrial& trial : TrialsOf(options)) {
    const double metres = trial.crossing == Crossing::kGreedy   ? 150.0
                          : trial.crossing == Crossing::kGuided ? 110.0 + double(trial.seed)
                                                                : 140.0;
    records[trial.name()] = Crossed(trial, metres);
  }
  records["seed002-greedy"].status = EpisodeStatus::kGoalsLeft;      // longer than any
  records["seed003-ig-mcts"].measures->distance_m = 160.0;           // longer than greedy
  records["seed004-ig-mcts-alone"].status = EpisodeStatus::kFailed;  // nothing was measured
  records["seed004-ig-mcts-alone"].measures.reset();

  const WaterwaySummary summary = Summarise(options, records);
  REQUIRE(summary.crossings.size() == 3);
  const CrossingSummary& guided = summary.crossings[1];
  CHECK(guided.reached == 5);
  CHECK(guided.path_over_optimum_median == Approx(1.14));
  CHECK(guided.path_over_optimum_mean == Approx(1.224));
  CHECK(guided.path_over_optimum_worst == Approx(1.6));
  CHECK(guided.decision_ms_p95 == Approx(215.0));
  CHECK(summary.crossings[0].reached == 4);
  CHECK(std::isinf(summary.crossings[0].path_over_optimum_worst));
  CHECK(guided.shorter_than_greedy_fraction == Approx(0.8));
  CHECK(summary.crossings[2].shorter_than_greedy_fraction == Approx(0.8));
  CHECK(summary.crossings[0].shorter_than_greedy_fraction == 0.0);
  CHECK(summary.failed == std::vector<std::string>{"seed004-ig-mcts-alone"});
  for (const WaterwayBar& bar : BarsOf(summary)) CHECK(bar.met());

  const auto json = WaterwayJson(summary, DesignOf(options));
  CHECK(json["waterway"]["reached_fraction"] == 1.0);
  CHECK(json["waterway"]["path_over_optimum_median"].get<double>() == Approx(1.14));
  CHECK(json["waterway"]["shorter_than_greedy_fraction"].get<double>() == Approx(0.8));
  CHECK(json["waterway"]["decision_p95_ms"].get<double>() == Approx(215.0));
  CHECK(json["crossings"][0]["path_over_optimum_worst"].is_null());
  CHECK_THAT(WaterwayText(summary), Catch::Contains("not reached") && Catch::Contains("4 of 5"));
  CHECK_THAT(WaterwayCsv(options, records), Catch::Contains("2,greedy,goals left,150.00,100.00"));

  records["seed001-ig-mcts"].status = EpisodeStatus::kGoalsLeft;
  CHECK_FALSE(BarsOf(Summarise(options, records)).front().met());
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
