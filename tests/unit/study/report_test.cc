#include "study/report.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/scoped_variable.h"
#include "support/text.h"
#include "support/xml_check.h"
#include "unit/study/sample_study.h"

namespace conav::study {
namespace {

using test::CountOf;

/// A study of three subjects and two layouts, one of whose episodes failed on demand.
struct Fixture {
  explicit Fixture(bool with_failure = false) {
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

TEST_CASE("The text says simulated, has table 3, bars and tests", "[study]") {
  const Fixture study;
  const std::string text = StudyText(study.report);
  for (const char* part :
       {"SIMULATED operators: 3 synthetic people x 3 methods x 2 layouts = 18 episodes",
        "Table 3: mean (SD) over episodes", "401 (0.894)", "Bars", "met", "Friedman chi^2",
        "ig-mcts - teleop", "d_z"}) {
    CHECK_THAT(text, Catch::Contains(part));
  }
  CHECK_THAT(text, !Catch::Contains("MISSED") && !Catch::Contains("did not reach"));
}

TEST_CASE("What cannot be tested is -, with the reason", "[study]") {
  const Fixture study;  // all spread is the subjects' own: every difference is the same for all
  const std::string text = StudyText(study.report);
  CHECK_THAT(text, !Catch::Contains("inf") && !Catch::Contains("nan"));
  CHECK_THAT(text, Catch::Contains("the difference is the same for every operator"));
  // Measures that are one in another unit are named.
  CHECK_THAT(text, Catch::Contains("steps and time s are one measure") &&
                       !Catch::Contains("steps and guidance are"));
}

TEST_CASE("How a study was made is told as it was typed", "[study]") {
  const test::ScopedVariable commit("CONAV_COMMIT", "0123abc");
  const char* const words[] = {"conav-study", "--out", "my study's", "--jobs", "1"};
  const Provenance made = DescribeRun(5, words);
  CHECK(made.command == R"(conav study --out 'my study'\''s' --jobs 1)");
  CHECK(made.commit == "0123abc");
  const auto section = ProvenanceSection(made, {{"seed", 7}, {"people", std::string(500, 'x')}});
  CHECK(section.rows.back() == std::vector<std::string>{"seed", "7"});
}

TEST_CASE("A failed episode is reported everywhere", "[study]") {
  const Fixture study(true);
  const std::string& name = study.design.episodes.front().name;
  CHECK_THAT(StudyText(study.report), Catch::Contains(name) && Catch::Contains("sim <died>"));
  CHECK(StudyJson(study.report)["failed"][0]["name"] == name);
  CHECK_THAT(EpisodesCsv(study.report), Catch::Contains("simulated,failed,2,,,,,,,,,,0.000\n"));
  CHECK_THAT(StudyPage(study.report), Catch::Contains("sim &lt;died&gt;"));
}

TEST_CASE("Bytes that nobody rendered are not told", "[study]") {
  const Fixture study;
  const StudyReport blind{study.design, study.document, study.records, study.summary, false, {}};
  CHECK_THAT(StudyText(blind), Catch::Contains("--camera none renders nothing") &&
                                   !Catch::Contains("image MiB and sent MiB"));
  // A picture has 1 KiB here: both are the number of pictures, in other units.
  CHECK_THAT(StudyText(study.report), Catch::Contains("image MiB and sent MiB are one measure"));
  CHECK(StudyJson(blind)["methods"]["teleop"]["sent_mib_mean"].is_null());
  CHECK(StudyJson(blind)["analyses"]["sent_mib"].is_null());
  CHECK_THAT(EpisodesCsv(blind), Catch::Contains(",complete,1,70.3125,,400,"));
}

TEST_CASE("JSON holds every figure of every method by name", "[study]") {
  const Fixture study;
  const auto json = StudyJson(study.report);
  CHECK(json["simulated"] == true);
  for (const char* method : {"ig-mcts", "instruction", "teleop"}) {
    for (const char* key :
         {"image_mib_mean", "image_mib_sd", "low_level_steps_mean", "cell_moves_mean",
          "pictures_mean", "guidance_mean", "goals_reached_fraction", "mapping_accuracy_after_mean",
          "mapping_accuracy_after_sd_subjects", "time_s_mean", "sent_mib_mean"}) {
      CAPTURE(method, key);
      CHECK(json["methods"][method][key].is_number());
    }
    CHECK(json["methods"][method]["episodes"] == 6);
  }
  CHECK(json["methods"]["ig-mcts"]["pictures_mean"] == 10.0);
  CHECK(json["methods"]["ig-mcts"]["goals_reached_fraction"] == 1.0);
  CHECK(json["analyses"]["low_level_steps"]["pairs"].size() == 3);
  CHECK(json["bars"].size() == 5);
}

TEST_CASE("The tidy CSV has a line per episode", "[study]") {
  const Fixture study;
  std::istringstream csv(EpisodesCsv(study.report));
  std::vector<std::string> lines;
  for (std::string line; std::getline(csv, line);) lines.push_back(line);
  REQUIRE(lines.size() == 19);
  CHECK(CountOf(lines[1], ",") == CountOf(lines[0], ","));
  CHECK_THAT(lines[1], Catch::StartsWith("s01,1,1,"));
}

TEST_CASE("The page shows a plot per measure and who had which method when", "[study]") {
  const Fixture study;
  const std::string page = StudyPage(study.report);
  CHECK_THAT(page, Catch::StartsWith("<!DOCTYPE html>"));
  CHECK(test::XmlError(page) == "");
  CHECK_THAT(page, Catch::Contains("SIMULATED operators") && Catch::Contains("Williams design"));
  CHECK_THAT(page, Catch::Contains(">Simulated time (s)</text>") &&
                       Catch::Contains("<td>conav study --jobs 1</td>"));
  CHECK_THAT(page, !Catch::Contains("text-anchor=\"end\">-"));  // no axis runs below 0
  CHECK(CountOf(page, "<svg") == static_cast<int>(Measures().size()));
}

}  // namespace
}  // namespace conav::study
