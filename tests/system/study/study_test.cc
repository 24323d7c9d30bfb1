#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "study/waterway_figure.h"
#include "support/program_runner.h"
#include "support/running_program.h"
#include "support/scoped_variable.h"
#include "support/test_domain.h"

namespace conav::test {
namespace {

/// A bench for conav-study, whose programs keep to the test's domain and whose study is in `study`.
class StudyFixture {
 public:
  ProgramOutcome Run(const std::string& arguments) const { return desk_.Run(arguments); }
  ProgramOutcome RunWaterway(const std::string& arguments) const {
    return desk_.RunOther("conav-waterway", arguments);
  }
  /// In the background, with --out study.
  RunningProgram Start(const std::string& arguments) const {
    return {"conav-study", arguments + " --out " + (desk_ / "study").string(), desk_ / "study.log"};
  }

  std::filesystem::path operator/(const std::string& name) const { return desk_ / name; }
  nlohmann::json Json(const std::string& name) const {
    return nlohmann::json::parse(ReadFile(desk_ / name).value());
  }
  std::ptrdiff_t Episodes() const {
    std::error_code none;
    const std::filesystem::directory_iterator files(desk_ / "study/episodes", none);
    return none ? 0 : std::count_if(begin(files), end(files), [](auto& e) {
      return e.path().extension() == ".json";
    });
  }

 private:
  ScopedVariable domain_{"CONAV_DOMAIN", std::to_string(TestDomain()).c_str()};
  ProgramRunner desk_{"conav-study"};
};

namespace fs = std::filesystem;

/// 2 operators, 2 methods, 1 layout: four episodes, one at a time.
constexpr const char* kSmall =
    "--operators 2 --layouts 1 --methods ig-mcts,instruction --references none --jobs 1 ";

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

TEST_CASE("a study runs over DDS, prints its table, and conav stats reads its measures",
          "[study]") {
  const StudyFixture bench;
  const ProgramOutcome study = bench.Run(SmallStudy("--json result.json"));
  INFO(study.text());
  REQUIRE(study.exit_code == 0);
  CHECK_THAT(study.out, Catch::Contains("SIMULATED operators") && Catch::Contains("Table 3") &&
                            Catch::Contains("partial eta^2"));
  CHECK_THAT(study.error, Catch::Contains("4 of 4 episodes"));

  const auto json = bench.Json("result.json");
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
      RunProgram("conav-stats", (bench / "study/measures/low_level_steps.csv").string());
  CHECK(stats.exit_code == 0);
  CHECK_THAT(stats.out, Catch::Contains("2 subjects, 2 conditions"));
  CHECK(fs::exists(bench / "study/report.html"));
  CHECK(fs::exists(bench / "study/people/s02.yaml"));

  // All is there: nothing runs again, and the table is the same.
  const ProgramOutcome again = bench.Run(SmallStudy());
  CHECK(again.exit_code == 0);
  CHECK(again.out == study.out);
  CHECK(again.error.empty());

  CHECK(bench.Run(SmallStudy("--seed 2")).exit_code == 2);
  CHECK(bench.Run("--out other --methods magic").exit_code == 2);
  CHECK_FALSE(fs::exists(bench / "other"));
}

TEST_CASE("a study that was killed or interrupted goes on and ends like one that was not",
          "[study]") {
  const int signal = GENERATE(SIGKILL, SIGTERM);
  const StudyFixture bench;
  RunningProgram first = bench.Start(kSmall);
  REQUIRE(WaitUntil([&] { return bench.Episodes() > 0; }, std::chrono::seconds(90)));
  first.Signal(signal);
  const launcher::ProcessEnd end = first.Wait(std::chrono::seconds(30));
  if (signal == SIGKILL) CHECK(end.signal == SIGKILL);
  if (signal == SIGTERM) {
    CHECK(end.exit_code == 1);
    CHECK_THAT(first.Output(), Catch::Contains("interrupted") && !Catch::Contains("failed"));
  }
  const ProgramOutcome rest = bench.Run(SmallStudy());
  INFO(rest.text());
  REQUIRE(rest.exit_code == 0);
  CHECK_THAT(rest.error, !Catch::Contains("1 of 4 episodes"));  // that one is there already
  CHECK(bench.Episodes() == 4);

  const ProgramOutcome whole = bench.Run(SmallStudy("", "whole"));
  REQUIRE(whole.exit_code == 0);
  CHECK(Lines(bench / "study/episodes.csv") == Lines(bench / "whole/episodes.csv"));
}

TEST_CASE("streams are measured as video where ffmpeg is installed", "[study]") {
  const StudyFixture bench;
  const ProgramOutcome study = bench.Run(
      "--operators 1 --layouts 1 --methods instruction --references none --camera egl --h264 "
      "--jobs 1 --out study --json r.json");
  INFO(study.text());
  if (study.exit_code == 2) {
    CHECK_THAT(study.error, Catch::Contains("ffmpeg"));
    return;
  }
  const auto method = bench.Json("r.json")["methods"]["instruction"];
  CHECK(method["h264_mib_mean"] > 0.0);
  CHECK(method["h264_mib_mean"] < method["sent_mib_mean"]);
}

TEST_CASE("an episode whose simulator dies is run again", "[study]") {
  const StudyFixture bench;
  RunningProgram study = bench.Start("--operators 1 --layouts 1 --methods ig-mcts --jobs 1");
  pid_t simulator = 0;
  REQUIRE(WaitUntil(
      [&] {
        std::ifstream children(fmt::format("/proc/{0}/task/{0}/children", study.pid()));
        return static_cast<bool>(children >> simulator);
      },
      std::chrono::seconds(30)));
  REQUIRE(kill(simulator, SIGKILL) == 0);
  const launcher::ProcessEnd end = study.Wait(std::chrono::seconds(90));
  INFO(study.Output());
  CHECK(end.exit_code == 0);
  CHECK(bench.Json("study/results.json")["methods"]["ig-mcts"]["episodes"] == 1);
  CHECK_THAT(ReadFile(bench / "study/episodes.csv").value(),
             Catch::Contains(",simulated,complete,2,"));
}

/// Two robots, both in one minute's work; the operator needs 3 s for everything.
constexpr const char* kSmallSupervision =
    "--supervision --robots 2 --minutes 0.7 --speed 10 "
    "--interaction-times picture=3,blocked=3,path=3,log_sd=0 ";

TEST_CASE("two robots and one operator: every trial is measured and every file is there",
          "[study]") {
  const StudyFixture bench;
  const ProgramOutcome study =
      bench.Run(std::string(kSmallSupervision) +
                "--orders priority,fifo --seeds 2 --out study --json result.json");
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
}

TEST_CASE("one waterway is crossed in three ways, and a figure without a picture has the graph",
          "[study]") {
  const StudyFixture bench;
  const ProgramOutcome study = bench.RunWaterway(
      "study waterway --seeds 1 --first-seed 7 --camera none --out study --json result.json");
  INFO(study.text());
  REQUIRE(study.exit_code == 0);
  CHECK_THAT(study.out, Catch::Contains("simulated operator") && Catch::Contains("1 of 1"));
  const auto waterway = bench.Json("result.json")["waterway"];
  CHECK(waterway["reached_fraction"] == 1.0);
  CHECK(waterway["path_over_optimum_median"] > 1.0);
  CHECK(waterway["path_over_optimum_median"] < 3.0);
  CHECK(waterway["shorter_than_greedy_fraction"].is_number());
  CHECK(waterway["decision_p95_ms"] > 0.0);

  const auto run = [&](const char* crossing) {
    return fs::directory_iterator(bench / "study/runs" / crossing)->path();
  };
  const auto figure = study::WaterwayFigure(run("seed007-greedy"), run("seed007-ig-mcts-alone"));
  CHECK_THAT(figure.value(), Catch::Contains("(c) robot") && Catch::Contains("sent no picture") &&
                                 !Catch::Contains("(e) predicted"));
}

TEST_CASE("figure 7 has its panels (a) to (e)", "[study]") {
  const StudyFixture bench;
  const ProgramOutcome figure = bench.RunWaterway("figure waterway --seed 7 --svg page.svg");
  INFO(figure.text());
  REQUIRE(figure.exit_code == 0);
  const std::string page = ReadFile(bench / "page.svg").value();
  for (const char* panel : {"(a) truth", "(b) operator", "(c) robot", "(d) the", "(e) predicted"}) {
    CHECK_THAT(page, Catch::Contains(panel));
  }
  CHECK_THAT(page, Catch::Contains("image/jpeg"));
  CHECK(bench.RunWaterway("figure waterway --check").exit_code == 2);
  CHECK(bench.RunWaterway("waterway").exit_code == 2);
}

}  // namespace
}  // namespace conav::test
