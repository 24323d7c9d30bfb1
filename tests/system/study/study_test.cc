#include <catch2/catch.hpp>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/runtime/file.h"
#include "launcher/process.h"
#include "support/program_desk.h"
#include "support/test_domain.h"
#include "system/launcher/demo_run.h"

namespace conav::test {
namespace {

namespace fs = std::filesystem;

/// 2 operators, 2 methods, 1 layout: four episodes, one at a time in a domain of our own.
std::string SmallStudy(const std::string& more = "", const std::string& out = "study") {
  return "--operators 2 --layouts 1 --methods ig-mcts,instruction --jobs 1 --out " + out + " " +
         more;
}

/// A desk whose programs keep to the test's domain.
class StudyDesk {
 public:
  StudyDesk() { setenv("CONAV_DOMAIN", std::to_string(TestDomain()).c_str(), 1); }
  ~StudyDesk() { unsetenv("CONAV_DOMAIN"); }

  ProgramOutcome Run(const std::string& arguments) const { return desk_.Run(arguments); }
  fs::path operator/(const std::string& name) const { return desk_ / name; }
  nlohmann::json Json(const std::string& name) const {
    return nlohmann::json::parse(ReadFile(desk_ / name).value());
  }
  std::size_t Episodes() const {
    std::error_code none;
    const fs::directory_iterator files(desk_ / "study/episodes", none);
    return none ? 0 : static_cast<std::size_t>(std::count_if(begin(files), end(files), [](auto& e) {
      return e.path().extension() == ".json";
    }));
  }

 private:
  ProgramDesk desk_{"conav-study"};
};

/// The episodes without wall times: what must be the same for the same seed.
std::vector<std::string> Lines(const fs::path& csv) {
  std::vector<std::string> lines;
  std::istringstream text(ReadFile(csv).value());
  for (std::string line; std::getline(text, line);)
    lines.push_back(line.substr(0, line.rfind(',')));
  return lines;
}

}  // namespace

TEST_CASE("a study runs over DDS, tells its table, and conav stats reads its measures",
          "[study][system]") {
  const StudyDesk desk;
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
  CHECK_THAT(other.error, Catch::Contains("belongs to another study: seed is 1 there, 2 here"));
}

TEST_CASE("a study that was killed goes on and ends like one that was not", "[study][system]") {
  const StudyDesk desk;
  const std::vector<std::string> words{CONAV_BIN_DIR + std::string("/conav-study"),
                                       "--operators",
                                       "2",
                                       "--layouts",
                                       "1",
                                       "--methods",
                                       "ig-mcts,instruction",
                                       "--jobs",
                                       "1",
                                       "--out",
                                       (desk / "study").string()};
  {
    launcher::Process first("conav-study", words, desk / "first.log");
    REQUIRE(
        conav::testing::WaitUntil([&] { return desk.Episodes() > 0; }, std::chrono::seconds(60)));
    first.Signal(SIGKILL);
    REQUIRE(conav::testing::WaitUntil([&] { return first.Poll(); }, std::chrono::seconds(10)));
  }
  const std::size_t kept = desk.Episodes();
  const ProgramOutcome rest = desk.Run(SmallStudy());
  INFO(rest.text());
  REQUIRE(rest.exit_code == 0);
  CHECK(kept >= 1);
  CHECK(desk.Episodes() == 4);

  const ProgramOutcome whole = desk.Run(SmallStudy("", "whole"));
  REQUIRE(whole.exit_code == 0);
  CHECK(Lines(desk / "study/episodes.csv") == Lines(desk / "whole/episodes.csv"));
}

TEST_CASE("an episode whose simulator dies is run again", "[study][system]") {
  const StudyDesk desk;
  const std::vector<std::string> words{CONAV_BIN_DIR + std::string("/conav-study"),
                                       "--operators",
                                       "1",
                                       "--layouts",
                                       "1",
                                       "--methods",
                                       "ig-mcts",
                                       "--jobs",
                                       "1",
                                       "--out",
                                       (desk / "study").string()};
  launcher::Process study("conav-study", words, desk / "study.log");
  pid_t simulator = 0;
  REQUIRE(conav::testing::WaitUntil(
      [&] {
        std::ifstream children(fmt::format("/proc/{0}/task/{0}/children", study.pid()));
        return static_cast<bool>(children >> simulator);
      },
      std::chrono::seconds(30)));
  REQUIRE(kill(simulator, SIGKILL) == 0);
  REQUIRE(conav::testing::WaitUntil([&] { return study.Poll(); }, std::chrono::seconds(90)));
  INFO(ReadFile(desk / "study.log").value());
  CHECK(study.end()->exit_code == 0);
  const auto results = desk.Json("study/results.json");
  CHECK(results["methods"]["ig-mcts"]["episodes"] == 1);
  CHECK_THAT(ReadFile(desk / "study/episodes.csv").value(),
             Catch::Contains(",simulated,complete,2,"));
}

TEST_CASE("an interrupted study says how to go on", "[study][system]") {
  const StudyDesk desk;
  const std::vector<std::string> words{CONAV_BIN_DIR + std::string("/conav-study"),
                                       "--operators",
                                       "20",
                                       "--layouts",
                                       "1",
                                       "--jobs",
                                       "1",
                                       "--out",
                                       (desk / "study").string()};
  launcher::Process study("conav-study", words, desk / "study.log");
  REQUIRE(conav::testing::WaitUntil([&] { return desk.Episodes() > 0; }, std::chrono::seconds(60)));
  study.Signal(SIGTERM);
  REQUIRE(conav::testing::WaitUntil([&] { return study.Poll(); }, std::chrono::seconds(30)));
  CHECK(study.end()->exit_code == 1);
  CHECK_THAT(ReadFile(desk / "study.log").value(), Catch::Contains("of 60 episodes are in") &&
                                                       Catch::Contains("the same command goes on"));
}

TEST_CASE("a study that cannot be is refused before anything runs", "[study][system]") {
  const StudyDesk desk;
  for (const char* wrong : {"--operators 0", "--methods magic", "--methods teleop,teleop",
                            "--jobs 2", "--weights /none", "--population /none.yaml",
                            "--camera film", "--operators two", "--colour", "--seed -1"}) {
    const ProgramOutcome outcome = desk.Run(std::string("--out study ") + wrong);
    CAPTURE(wrong, outcome.text());
    CHECK(outcome.exit_code != 0);
    CHECK(outcome.out.empty());
  }
  CHECK_FALSE(fs::exists(desk / "study"));
  const ProgramOutcome help = desk.Run("--help");
  CHECK(help.exit_code == 0);
  CHECK_THAT(help.out, Catch::Contains("Williams design") && Catch::Contains("SIMULATED"));
}

}  // namespace conav::test
