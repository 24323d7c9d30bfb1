#include <catch2/catch.hpp>
#include <csignal>
#include <fstream>

#include "system/study/study_fixture.h"

namespace conav::test {
namespace {

namespace fs = std::filesystem;

/// 2 operators, 2 methods, 1 layout: four episodes, one at a time.
constexpr const char* kSmall = "--operators 2 --layouts 1 --methods ig-mcts,instruction --jobs 1 ";

std::string SmallStudy(const std::string& more = "", const std::string& out = "study") {
  return kSmall + more + " --out " + out;
}

/// The episodes without wall times: what must be the same for the same seed.
std::vector<std::string> Lines(const fs::path& csv) {
  std::vector<std::string> lines;
  std::istringstream text(ReadFile(csv).value());
  for (std::string line; std::getline(text, line);)
    lines.push_back(line.substr(0, line.rfind(',')));
  return lines;
}

}  // namespace

TEST_CASE("a study runs over DDS, prints its table, and conav stats reads its measures",
          "[study]") {
  const StudyFixture desk;
  const ProgramOutcome study = desk.Run(SmallStudy("--json result.json"));
  INFO(study.text());
  REQUIRE(study.exit_code == 0);
  CHECK_THAT(study.out, Catch::Contains("SIMULATED operators") &&
                            Catch::Contains("Table 3: mean (SD) over episodes") &&
                            Catch::Contains("partial eta^2"));
  CHECK_THAT(study.error, Catch::Contains("4 of 4 episodes"));

  const auto json = desk.Json("result.json");
  CHECK(json["simulated"] == true);
  CHECK(json["failed"].empty());
  for (const char* method : {"ig-mcts", "instruction"}) {
    CHECK(json["methods"][method]["episodes"] == 2);
    CHECK(json["methods"][method]["goals_reached_fraction"] == 1.0);
    CHECK(json["methods"][method]["low_level_steps_mean"] > 50.0);
    CHECK(json["methods"][method]["time_s_mean"] > 10.0);
  }
  CHECK(json["methods"]["instruction"]["image_mib_mean"] >
        json["methods"]["ig-mcts"]["image_mib_mean"]);

  const auto stats =
      RunProgram("conav-stats", (desk / "study/measures/low_level_steps.csv").string());
  CHECK(stats.exit_code == 0);
  CHECK_THAT(stats.out, Catch::Contains("low_level_steps.csv: 2 subjects, 2 conditions"));
  CHECK(fs::exists(desk / "study/report.html"));
  CHECK(fs::exists(desk / "study/people/s02.yaml"));

  // All is there: nothing runs again, and the table is the same.
  const ProgramOutcome again = desk.Run(SmallStudy());
  CHECK(again.exit_code == 0);
  CHECK(again.out == study.out);
  CHECK(again.error.empty());

  const ProgramOutcome other = desk.Run(SmallStudy("--seed 2"));
  CHECK(other.exit_code == 2);
  CHECK_THAT(other.error, Catch::Contains("seed is 1 there, 2 here"));
  CHECK(desk.Run("--out other --methods magic").exit_code == 2);
  CHECK_FALSE(fs::exists(desk / "other"));
}

TEST_CASE("a study that was killed goes on and ends like one that was not", "[study]") {
  const StudyFixture desk;
  RunningStudy first(desk, kSmall);
  WaitForRecord(desk, "episodes");
  CHECK(first.End(SIGKILL).signal == SIGKILL);
  const ProgramOutcome rest = desk.Run(SmallStudy());
  INFO(rest.text());
  REQUIRE(rest.exit_code == 0);
  CHECK_THAT(rest.error, !Catch::Contains("1 of 4 episodes"));  // that one is there already
  CHECK(desk.Records("episodes") == 4);

  const ProgramOutcome whole = desk.Run(SmallStudy("", "whole"));
  REQUIRE(whole.exit_code == 0);
  CHECK(Lines(desk / "study/episodes.csv") == Lines(desk / "whole/episodes.csv"));
}

TEST_CASE("an episode whose simulator dies is run again", "[study]") {
  const StudyFixture desk;
  RunningStudy study(desk, "--operators 1 --layouts 1 --methods ig-mcts --jobs 1");
  pid_t simulator = 0;
  REQUIRE(conav::testing::WaitUntil(
      [&] {
        std::ifstream children(fmt::format("/proc/{0}/task/{0}/children", study.pid()));
        return static_cast<bool>(children >> simulator);
      },
      std::chrono::seconds(30)));
  REQUIRE(kill(simulator, SIGKILL) == 0);
  const launcher::ProcessEnd end = study.Wait(std::chrono::seconds(90));
  INFO(ReadFile(desk.log()).value());
  CHECK(end.exit_code == 0);
  CHECK(desk.Json("study/results.json")["methods"]["ig-mcts"]["episodes"] == 1);
  CHECK_THAT(ReadFile(desk / "study/episodes.csv").value(),
             Catch::Contains(",simulated,complete,2,"));
}

}  // namespace conav::test
