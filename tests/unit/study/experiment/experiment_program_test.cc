#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/program_runner.h"
#include "support/text.h"
#include "support/xml_check.h"

namespace conav {
namespace {

using Catch::Matchers::Contains;

const std::string kShort = "search --seeds 1 --model glpf --variants single-100 ";

TEST_CASE("conav-experiment prints a table and writes JSON and CSV", "[planner][experiment]") {
  const test::ProgramRunner bench("conav-experiment");
  const auto outcome = bench.Run(kShort + "--operators careful,silent --json s.json --csv s.csv");
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.out, Contains("SIMULATED") && Contains("single-100"));
  const auto json = nlohmann::json::parse(ReadFile(bench / "s.json").value());
  REQUIRE(json.at("rows").size() == 2);
  CHECK(json.at("operators") == "simulated");
  CHECK(json.at("rows")[1].at("operator") == "silent");
  CHECK(json.at("rows")[0].at("moves").at("low") <= json.at("rows")[0].at("moves").at("mean"));
  CHECK_THAT(ReadFile(bench / "s.csv").value(), Catch::StartsWith("variant,operator,seed,"));
}

TEST_CASE("conav-experiment keeps mazes, and gives the same tables from those of other processes",
          "[planner][experiment]") {
  const test::ProgramRunner bench("conav-experiment");
  for (const std::string command : {"search --variants single-100 ",
                                    "scenarios --scenarios seen-goals,paper --methods greedy "}) {
    const std::string common =
        command + "--seeds 2 --model glpf --operators careful,silent --csv episodes.csv ";
    REQUIRE(bench.Run(common).exit_code == 0);
    const std::string whole = ReadFile(bench / "episodes.csv").value();
    std::filesystem::remove(bench / "episodes.csv");
    const std::string records = "--records " + command.substr(0, command.find(' '));
    REQUIRE(bench.Run(common + records + " --piece 1").exit_code == 0);
    CHECK_FALSE(std::filesystem::exists(bench / "episodes.csv"));
    REQUIRE(bench.Run(common + records).exit_code == 0);
    CHECK((ReadFile(bench / "episodes.csv").value() == whole));
  }
}

TEST_CASE("conav-experiment searches in a scenario, and draws what its operators got",
          "[planner][experiment]") {
  const test::ProgramRunner bench("conav-experiment");
  const auto outcome =
      bench.Run(kShort +
                "--operators careful --scenario seen-goals --search paper --json s.json "
                "--svg s.svg");
  CHECK(outcome.exit_code == 0);
  const auto json = nlohmann::json::parse(ReadFile(bench / "s.json").value());
  CHECK(json.at("scenario") == "seen-goals");
  CHECK(json.at("search") == "paper");
  CHECK(json.at("preset") == "loop-free21");
  const std::string plot = ReadFile(bench / "s.svg").value();
  CHECK_THAT(plot, Contains("single-100") && !Contains("nan"));
  CHECK(test::XmlError(plot) == "");
}

TEST_CASE("conav-experiment draws the trade-off of pictures and moves", "[planner][experiment]") {
  const test::ProgramRunner bench("conav-experiment");
  const auto outcome = bench.Run(
      "tradeoff --seeds 1 --model glpf --operators careful,hasty --json t.json --csv t.csv --svg "
      "t.svg");
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.out,
             Contains("SIMULATED") && Contains("threshold") && Contains("IG-MCTS is better at"));
  const auto json = nlohmann::json::parse(ReadFile(bench / "t.json").value());
  CHECK(json.at("policies").size() == 12);
  const std::string csv = ReadFile(bench / "t.csv").value();
  CHECK_THAT(csv, Catch::StartsWith("policy,parameter,operator,seed,"));
  CHECK(test::CountOf(csv, "\n") == 1 + static_cast<int>(json.at("points").size()));
  const std::string plot = ReadFile(bench / "t.svg").value();
  CHECK_THAT(plot, Contains("simulated operator: hasty") && !Contains("nan") && !Contains("inf"));
  CHECK(test::XmlError(plot) == "");
}

TEST_CASE("conav-experiment refuses wrong use with 2 and says what is wrong, before the work",
          "[planner][experiment]") {
  const test::ProgramRunner bench("conav-experiment");
  CHECK(bench.Run("--help").exit_code == 0);
  CHECK(bench.Run("").exit_code == 2);
  std::vector<std::pair<std::string, std::string>> rows{
      {"sweep", "'sweep'"},
      {"search --operators grumpy", "grumpy"},
      {"search --seeds 0", "--seeds"},
      {"search --first-seed -1", "--first-seed: '-1'"},
      {"search --variants best", "no variant best"},
      {"search --variants best", "paper-literal"},
      {"tradeoff --variant best", "no variant best"},
      {"search --scenario moon", "moon"},
      {"search --scenario large --preset conav13", "--preset"},
      {"scenarios --robots 0", "--robots"},
      {"search --json nowhere/s.json", "nowhere"},
      {"tradeoff --svg nowhere/t.svg", "nowhere"},
      {"tradeoff --turn-cost nan", "nan is not a number"},
      {"tradeoff --json t.json --csv t.json", "t.json"}};
  for (const std::string experiment : {"search ", "tradeoff "}) {
    rows.emplace_back(experiment + "--preset round", "round");
    rows.emplace_back(experiment + "--search none.yaml", "--search: neither a search");
    rows.emplace_back(experiment + "--weights none.nhpm", "--weights none.nhpm");
    rows.emplace_back(experiment + "--model glpf --weights /dev/null", "--model glpf");
    rows.emplace_back(experiment + "--variants-file none.yaml", "none.yaml");
  }
  for (const auto& [arguments, why] : rows) {
    CAPTURE(arguments);
    const auto outcome = bench.Run(arguments);
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.out.empty());
    CHECK_THAT(outcome.error, Contains(why));
  }
}

}  // namespace
}  // namespace conav
