#include "study/report.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "study/statistics/table_reader.h"
#include "support/scoped_variable.h"
#include "support/text.h"
#include "support/xml_check.h"
#include "unit/study/sample_study.h"

namespace conav::study {
namespace {

using test::CountOf;

/// A study of three subjects and two layouts, one of whose episodes failed on demand.
struct ReportFixture {
  explicit ReportFixture(bool with_failure = false) {
    if (!with_failure) return;
    const std::string& name = design.episodes.front().name;
    records[name] = {.name = name, .detail = "sim <died>", .attempts = 2};
    summary = Summarise(design, records);
  }

  Design design = MakeDesign({.operators = 3, .layouts = 2});
  nlohmann::ordered_json document{{"seed", 1}};
  Records records = SampleRecords(design);
  StudySummary summary = Summarise(design, records);
  StudyReport report{design,  document, records,
                     summary, true,     {"conav study --jobs 1", "0123abc", "today", "here"}};
};

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
    robot.images = 5;
    robot.image_bytes = 1000;
    robot.guidance = 2;
    robot.time_s = time_s;
    metrics.robots.push_back(robot);
  }
  const EpisodeMeasures measures = MeasuresOf(metrics);
  CHECK(measures == EpisodeMeasures{.images = 10,
                                    .image_bytes = 2000,
                                    .low_level_steps = 600,
                                    .cell_moves = 40,
                                    .guidance = 4,
                                    .mapping_accuracy_after = 0.7,
                                    .goals_reached = 8,
                                    .goals_total = 8,
                                    .time_s = 60.0,
                                    .all_goals_reached = true});
  // Table 3 of the paper: 609.71 steps with a picture each are 107.18 MB.
  const EpisodeMeasures paper = SampleMeasures(609.71, 609.71);
  CHECK(Measures()[MeasureIndex("image_mib")].value(paper) == Approx(107.18).margin(0.005));
  CHECK(Measures()[MeasureIndex("sent_mib")].value(paper) == Approx(609.71 / 1024.0));
}

TEST_CASE("Methods are described by mean and SD over episodes and over subjects", "[study]") {
  const ReportFixture study;
  const StudySummary& summary = study.summary;
  REQUIRE(summary.methods.size() == 3);
  const std::size_t steps = MeasureIndex("low_level_steps");
  CHECK(summary.methods[0].episodes == 6);
  CHECK(summary.methods[0].measures[steps].mean == Approx(401.0));
  CHECK(summary.methods[2].measures[steps].mean == Approx(451.0));
  CHECK(summary.methods[0].measures[steps].sd == Approx(std::sqrt(4.0 / 5.0)));
  CHECK(summary.methods[0].sd_subjects[steps] == Approx(1.0));
  REQUIRE(summary.analyses[steps].analysis);
  CHECK(summary.analyses[steps].analysis->pairs[1].t.mean_difference == Approx(-50.0));
  CHECK(summary.failed.empty());
}

TEST_CASE(
    "A failed episode is reported, leaves an empty cell, its subject is left out of the tests",
    "[study]") {
  const ReportFixture study(true);
  const StudySummary& summary = study.summary;
  const PlannedEpisode& failed = study.design.episodes.front();
  CHECK(summary.failed.size() == 1);
  const std::size_t steps = MeasureIndex("low_level_steps");
  const auto table = statistics::ParseTable(summary.analyses[steps].csv, "steps.csv");
  REQUIRE(table);
  REQUIRE(table->left_out.size() == 1);
  CHECK(table->left_out[0].subject == "s01");
  CHECK(table->left_out[0].missing == Names(std::vector{failed.row.method}));
  CHECK(summary.analyses[steps].analysis->table.subject_count() == 2);
  CHECK_THAT(StudyText(study.report),
             Catch::Contains(failed.name) && Catch::Contains("sim <died>"));
  CHECK(StudyJson(study.report)["failed"][0]["name"] == failed.name);
  CHECK_THAT(EpisodesCsv(study.report), Catch::Contains("simulated,failed,2,,,,,,,,,,,,0.000\n"));
  CHECK_THAT(StudyPage(study.report), Catch::Contains("sim &lt;died&gt;"));
}

TEST_CASE("One subject or one method has a table but no tests", "[study]") {
  for (const DesignOptions& options :
       {DesignOptions{.operators = 1}, DesignOptions{.methods = {MethodKind::kTeleop}}}) {
    const Design design = MakeDesign(options);
    const StudySummary summary = Summarise(design, SampleRecords(design));
    CHECK_FALSE(summary.analyses[0].analysis);
    CHECK_FALSE(summary.analyses[0].why_not.empty());
    CHECK(summary.bars.size() == (options.operators == 1 ? 5 : 1));
  }
}

TEST_CASE("Bars compare IG-MCTS with both baselines", "[study]") {
  ReportFixture study;
  std::vector<Bar> bars = study.summary.bars;
  REQUIRE(bars.size() == 5);
  CHECK(BarOf(bars, "image_bytes_saved_against_instruction") == Approx(1.0 - 10.0 / 401.0));
  for (const Bar& bar : bars) CHECK(bar.met());
  for (auto& [name, record] : study.records) {
    if (name.find("ig-mcts") == std::string::npos) continue;
    record.measures = SampleMeasures(20.0, 460.0);
    record.measures->all_goals_reached = false;
  }
  bars = Summarise(study.design, study.records).bars;
  for (const Bar& bar : bars) CHECK_FALSE(bar.met());
  CHECK(BarOf(bars, "steps_ratio_to_instruction") == Approx(460.0 / 401.0));
  CHECK(BarOf(bars, "episodes_with_all_goals") == Approx(2.0 / 3.0));
}

TEST_CASE("References and speeds are rows beside the methods, with their own tests", "[study]") {
  const Design design = MakeDesign({.operators = 3,
                                    .layouts = 2,
                                    .references = {"greedy", "never-send"},
                                    .teleop_speeds = {0.8, 2.0}});
  REQUIRE(design.episodes.size() == 36);
  Records records = SampleRecords(design);
  for (auto& [name, record] : records) {
    if (name.find("teleop-2-") != std::string::npos) record.measures->low_level_steps = 300.0;
    if (name.find("greedy") != std::string::npos)
      record.measures->low_level_steps += record.name[2];
  }
  EstimateHumanTimes(design, {4.0, 6.0, 6.0, 0.5}, records);
  const StudySummary summary = Summarise(design, records);
  CHECK(summary.analyses[0].analysis->table.condition_count() == 3);  // the order's
  CHECK(summary.comparable.analysis->table.conditions ==
        std::vector<std::string>{"ig-mcts", "instruction", "teleop", "greedy", "never-send",
                                 "teleop-2"});
  // 401 of 300 at 2 m/s and 451 at 0.8 m/s, linear in 1 / speed.
  CHECK(summary.break_even_mps.value() ==
        Approx(1.0 / (0.5 + (401.0 - 300.0) / (451.0 - 300.0) * 0.75)));
  CHECK(summary.methods[0].human.middle == Approx(10 * 4.0 + 3 * 6.0));
  CHECK(summary.methods[1].human.middle == Approx(3 * 6.0 + 0.03 * 401.0 * 4.0));
  CHECK(summary.methods[1].human.waiting == Approx(18.0));
  CHECK(summary.methods[2].human.high == Approx(451.0 * 0.25));
  CHECK(summary.methods[3].human == HumanTime{});
  const Provenance provenance{};
  const nlohmann::ordered_json document;
  const auto json = StudyJson({design, document, records, summary, false, provenance, {}});
  CHECK(json["comparable"]["instruction"]["ratio"] == 1.0);
  CHECK(json["comparable"]["teleop"]["equivalent"] == false);
  CHECK(json["methods"]["never-send"]["human_time_s_mean"] == 58.0);
}

TEST_CASE("The text says simulated, has table 3, bars and tests", "[study]") {
  const ReportFixture study;
  const std::string text = StudyText(study.report);
  for (const char* part : {"SIMULATED", "3 synthetic people", "18 episodes", "Table 3",
                           "401 (0.894)", "Bars", "Friedman", "ig-mcts - teleop", "d_z"}) {
    CHECK_THAT(text, Catch::Contains(part));
  }
  CHECK_THAT(text, !Catch::Contains("MISSED") && !Catch::Contains("did not reach"));
}

TEST_CASE("A test that is not possible prints -, with the reason", "[study]") {
  const ReportFixture study;  // every difference is the same for all subjects
  const std::string text = StudyText(study.report);
  CHECK_THAT(text, !Catch::Contains("inf") && !Catch::Contains("nan"));
  CHECK_THAT(text, Catch::Contains("the difference is the same for every subject"));
  // Measures that are one in another unit are named.
  CHECK_THAT(text, Catch::Contains("steps and time s are one measure") &&
                       !Catch::Contains("steps and guidance are"));
}

TEST_CASE("The provenance names the command as it was typed", "[study]") {
  const test::ScopedVariable commit("CONAV_COMMIT", "0123abc");
  const char* const words[] = {"conav-study", "--out", "my study's", "--jobs", "1"};
  const Provenance made = DescribeRun("conav study", 5, words);
  CHECK(made.command == R"(conav study --out 'my study'\''s' --jobs 1)");
  CHECK(made.commit == "0123abc");
  const auto section = ProvenanceSection(made, {{"seed", 7}, {"people", std::string(500, 'x')}});
  CHECK(section.rows.back() == std::vector<std::string>{"seed", "7"});
}

TEST_CASE("Without pixels no bytes are reported", "[study]") {
  const ReportFixture study;
  const StudyReport blind{study.design, study.document, study.records, study.summary, false, {}};
  CHECK_THAT(StudyText(blind), Catch::Contains("--camera none renders nothing") &&
                                   !Catch::Contains("image MiB and sent MiB"));
  // A picture has 1 KiB here: both are the number of pictures, in other units.
  CHECK_THAT(StudyText(study.report), Catch::Contains("image MiB and sent MiB are one measure"));
  CHECK(StudyJson(blind)["methods"]["teleop"]["sent_mib_mean"].is_null());
  CHECK(StudyJson(blind)["analyses"]["sent_mib"].is_null());
  CHECK_THAT(EpisodesCsv(blind), Catch::Contains(",complete,1,70.3125,,,400,"));
}

TEST_CASE("JSON holds every figure of every method by name", "[study]") {
  const ReportFixture study;
  const auto json = StudyJson(study.report);
  CHECK(json["simulated"] == true);
  for (const char* method : {"ig-mcts", "instruction", "teleop"}) {
    for (const char* key : {"image_mib_mean", "image_mib_sd", "low_level_steps_mean",
                            "cell_moves_mean", "guidance_mean", "mapping_accuracy_after_mean",
                            "mapping_accuracy_after_sd_subjects", "time_s_mean", "sent_mib_mean"}) {
      CAPTURE(method, key);
      CHECK(json["methods"][method][key].is_number());
    }
  }
  CHECK(json["methods"]["ig-mcts"]["episodes"] == 6);
  CHECK(json["methods"]["ig-mcts"]["pictures_mean"] == 10.0);
  CHECK(json["methods"]["ig-mcts"]["goals_reached_fraction"] == 1.0);
  CHECK(json["analyses"]["low_level_steps"]["pairs"].size() == 3);
  CHECK(json["bars"].size() == 5);
}

TEST_CASE(
    "The CSV has a line per episode, the page a plot per measure and who had which method when",
    "[study]") {
  const ReportFixture study;
  const std::string csv = EpisodesCsv(study.report);
  CHECK(CountOf(csv, "\n") == 19);
  CHECK(CountOf(csv, ",") == 19 * CountOf(csv.substr(0, csv.find('\n')), ","));
  CHECK_THAT(csv, Catch::Contains("\ns01,1,1,"));
  const std::string page = StudyPage(study.report);
  CHECK(test::XmlError(page) == "");
  for (const char* part : {"<!DOCTYPE html>", "SIMULATED operators", "Williams design",
                           ">Simulated time (s)</text>", "<td>conav study --jobs 1</td>"}) {
    CHECK_THAT(page, Catch::Contains(part));
  }
  CHECK_THAT(page, !Catch::Contains("text-anchor=\"end\">-"));              // no axis runs below 0
  CHECK(CountOf(page, "<svg") == static_cast<int>(Measures().size()) - 1);  // no video
}

TEST_CASE("a section without a table has its remarks", "[study]") {
  const ReportSection section{.title = "Comparable", .remarks = {"one operator only"}};
  CHECK(SectionsText({&section, 1}) == "\nComparable\n  one operator only\n");
  CHECK(SectionsHtml({&section, 1}) == "<h2>Comparable</h2>\n<p>one operator only</p>\n");
}

}  // namespace
}  // namespace conav::study
