// The supervision study in small: real processes, real DDS, real MuJoCo.
#include <catch2/catch.hpp>
#include <csignal>
#include <filesystem>

#include "system/study/study_fixture.h"

namespace conav::test {
namespace {

/// Two robots, both in one minute's work; the operator needs 3 s for everything.
constexpr const char* kSmallStudy =
    "--supervision --robots 2 --minutes 0.7 --speed 10 "
    "--interaction-times picture=3,blocked=3,path=3,log_sd=0 ";

TEST_CASE("two robots and one operator: every trial is measured and every file is there",
          "[study]") {
  const StudyFixture bench;
  const std::string command =
      std::string(kSmallStudy) + "--orders priority,fifo --seeds 2 --out study --json result.json";
  const ProgramOutcome study = bench.Run(command);
  INFO(study.text());
  REQUIRE(study.exit_code == 0);
  CHECK_THAT(study.out, Catch::Contains("SIMULATED operator") && Catch::Contains("2 priority") &&
                            Catch::Contains("M/M/1//N"));
  const auto json = bench.Json("result.json");
  REQUIRE(json["cells"].size() == 2);
  for (const auto& cell : json["cells"]) {
    INFO(cell.dump());
    CHECK(cell["trials"] == 2);
    CHECK(cell["goals_per_minute_mean"] > 0.0);
    CHECK(cell["interaction_s_mean"] >= 2.5);
    CHECK(cell["interaction_s_mean"] <= 6.0);
    CHECK(cell["utilisation_mean"] > 0.0);
    CHECK(cell["utilisation_mean"] <= 1.0);
    CHECK(cell["attended_robots_mean"] > 0.5);
    CHECK(cell["attended_robots_mean"] <= 2.0);
  }
  CHECK(json["comparisons"].size() == 3);
  for (const char* file : {"trials.csv", "results.json", "supervision.svg", "report.html"}) {
    CHECK(std::filesystem::file_size(bench / ("study/" + std::string(file))) > 100);
  }

  // All is there: nothing runs again, and the tables are the same.
  const ProgramOutcome again = bench.Run(command);
  CHECK(again.exit_code == 0);
  CHECK(again.out == study.out);
  CHECK(again.error.empty());

  const ProgramOutcome other = bench.Run(command + " --goals 29");
  CHECK(other.exit_code == 2);
  CHECK_THAT(other.error, Catch::Contains("goals is 30 there, 29 here"));
  CHECK(bench.Run("--supervision --orders lifo --out other").exit_code == 2);
  CHECK_FALSE(std::filesystem::exists(bench / "other"));
}

TEST_CASE("a supervision study that was interrupted goes on, and more seeds add to it", "[study]") {
  const StudyFixture bench;
  RunningStudy first(bench, std::string(kSmallStudy) + "--orders fifo --seeds 20");
  WaitForRecord(bench, "trials");
  CHECK(first.End(SIGTERM).exit_code == 1);
  CHECK_THAT(ReadFile(bench.log()).value(),
             Catch::Contains("of 20 trials are in") && !Catch::Contains("failed"));
  const std::string kept = ReadFile(bench / "study/trials/n02-fifo-seed1.json").value();

  const ProgramOutcome rest =
      bench.Run(std::string(kSmallStudy) + "--orders fifo --seeds 3 --out study");
  INFO(rest.text());
  REQUIRE(rest.exit_code == 0);
  CHECK(bench.Records("trials") == 3);
  CHECK(ReadFile(bench / "study/trials/n02-fifo-seed1.json").value() == kept);
  CHECK(bench.Json("study/results.json")["cells"][0]["trials"] == 3);
}

}  // namespace
}  // namespace conav::test
