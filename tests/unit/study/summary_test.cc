#include <algorithm>
#include <catch2/catch.hpp>

#include "study/report.h"
#include "study/statistics/table_reader.h"
#include "unit/study/sample_study.h"

namespace conav::study {
namespace {

double MeanOf(const StudySummary& summary, std::size_t method, const std::string& measure) {
  return summary.methods[method].measures[MeasureIndex(measure)].mean;
}

Design SmallDesign() { return MakeDesign({.operators = 3, .layouts = 2}); }

double BarOf(const std::vector<Bar>& bars, const std::string& key) {
  const auto bar = std::find_if(bars.begin(), bars.end(), [&](auto& b) { return b.key == key; });
  REQUIRE(bar != bars.end());
  return bar->value;
}

TEST_CASE("An episode's measures are sums over its robots", "[study]") {
  launcher::EpisodeMetrics metrics;
  metrics.all_goals_reached = true;
  metrics.after.mapping = 0.7;
  for (const double time_s : {40.0, 60.0}) {
    launcher::RobotMetrics robot{.goals_reached = 4, .goals_total = 4, .cell_moves = 20};
    robot.low_level_steps = 300;
    robot.pictures = 5;
    robot.picture_bytes = 1000;
    robot.guidance = 2;
    robot.time_s = time_s;
    metrics.robots.push_back(robot);
  }
  const EpisodeMeasures measures = MeasuresOf(metrics);
  CHECK(measures == EpisodeMeasures{.pictures = 10,
                                    .picture_bytes = 2000,
                                    .low_level_steps = 600,
                                    .cell_moves = 40,
                                    .guidance = 4,
                                    .mapping_accuracy_after = 0.7,
                                    .goals_reached = 8,
                                    .goals_total = 8,
                                    .time_s = 60.0,
                                    .all_goals_reached = true});
}

TEST_CASE("Communication is counted as the paper counts it", "[study]") {
  // Table 3: 609.71 steps with a picture each are 107.18 MB.
  const EpisodeMeasures measures = SampleMeasures(609.71, 609.71);
  CHECK(Measures()[MeasureIndex("image_mib")].value(measures) == Approx(107.18).margin(0.005));
  CHECK(Measures()[MeasureIndex("sent_mib")].value(measures) == Approx(609.71 / 1024.0));
}

TEST_CASE("Methods are described by mean and SD over episodes and over subjects", "[study]") {
  const Design design = SmallDesign();
  const Records records = SampleRecords(design);
  const StudySummary summary = Summarise(design, records);
  REQUIRE(summary.methods.size() == 3);
  CHECK(summary.methods[0].episodes == 6);
  CHECK(MeanOf(summary, 0, "low_level_steps") == Approx(401.0));
  CHECK(MeanOf(summary, 2, "low_level_steps") == Approx(451.0));
  const std::size_t steps = MeasureIndex("low_level_steps");
  CHECK(summary.methods[0].measures[steps].sd == Approx(std::sqrt(4.0 / 5.0)));
  CHECK(summary.methods[0].sd_subjects[steps] == Approx(1.0));
  REQUIRE(summary.analyses[steps].analysis);
  CHECK(summary.analyses[steps].analysis->pairs[1].t.mean_difference == Approx(-50.0));
  CHECK(summary.failed.empty());
}

TEST_CASE("A subject with a failed episode has an empty cell and is left out of the tests",
          "[study]") {
  const Design design = SmallDesign();
  Records records = SampleRecords(design);
  const PlannedEpisode& victim = design.episodes.front();
  records[victim.name] = {.name = victim.name, .detail = "sim died", .attempts = 2};
  const StudySummary summary = Summarise(design, records);
  CHECK(summary.failed.size() == 1);
  const std::size_t steps = MeasureIndex("low_level_steps");
  const auto table = statistics::ParseTable(summary.analyses[steps].csv, "steps.csv");
  REQUIRE(table);
  REQUIRE(table->left_out.size() == 1);
  CHECK(table->left_out[0].subject == "s01");
  CHECK(table->left_out[0].missing == std::vector<std::string>{victim.method});
  CHECK(summary.analyses[steps].analysis->table.subject_count() == 2);
}

TEST_CASE("One subject or one method has a table but no tests", "[study]") {
  DesignOptions one{.operators = 1};
  const Design alone = MakeDesign(one);
  const StudySummary summary = Summarise(alone, SampleRecords(alone));
  CHECK_FALSE(summary.analyses[0].analysis);
  CHECK_FALSE(summary.analyses[0].why_not.empty());
  const Design single = MakeDesign({.operators = 3, .layouts = 1, .methods = {"teleop"}});
  CHECK_FALSE(Summarise(single, SampleRecords(single)).analyses[0].analysis);
  CHECK(Summarise(single, SampleRecords(single)).bars.size() == 1);
}

TEST_CASE("Bars compare IG-MCTS with both baselines", "[study]") {
  const Design design = SmallDesign();
  Records records = SampleRecords(design);
  auto bars = CheckBars(Summarise(design, records).methods);
  REQUIRE(bars.size() == 5);
  CHECK(BarOf(bars, "image_bytes_saved_against_instruction") == Approx(1.0 - 10.0 / 401.0));
  for (const Bar& bar : bars) CHECK(bar.met());
  for (auto& [name, record] : records) {
    if (name.find("ig-mcts") == std::string::npos) continue;
    record.measures = SampleMeasures(20.0, 460.0);
    record.measures->all_goals_reached = false;
  }
  bars = CheckBars(Summarise(design, records).methods);
  for (const Bar& bar : bars) CHECK_FALSE(bar.met());
  CHECK(BarOf(bars, "steps_ratio_to_instruction") == Approx(460.0 / 401.0));
  CHECK(BarOf(bars, "episodes_with_all_goals") == Approx(2.0 / 3.0));
}

}  // namespace
}  // namespace conav::study
