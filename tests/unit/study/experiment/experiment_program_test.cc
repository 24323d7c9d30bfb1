// conav-experiment as a user meets it: files, messages, exit codes.
#include <nlohmann/json.hpp>

#include "support/program_runner.h"
#include "support/text.h"
#include "support/xml_check.h"

namespace conav {
namespace {

using Catch::Matchers::Contains;

const std::string kShort = "search --seeds 1 --model glpf --variants single-100 ";

TEST_CASE("conav-experiment prints a table and writes JSON and CSV", "[planner][experiment]") {
  const test::ProgramRunner desk("conav-experiment");
  const auto outcome = desk.Run(kShort + "--operators careful,silent --json s.json --csv s.csv");
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.out, Contains("SIMULATED") && Contains("single-100"));
  const auto json = nlohmann::json::parse(ReadFile(desk / "s.json").value());
  REQUIRE(json.at("rows").size() == 2);
  CHECK(json.at("operators") == "simulated");
  CHECK(json.at("rows")[1].at("operator") == "silent");
  CHECK(json.at("rows")[0].at("moves").at("low") <= json.at("rows")[0].at("moves").at("mean"));
  CHECK_THAT(ReadFile(desk / "s.csv").value(), Catch::StartsWith("variant,operator,seed,"));
}

TEST_CASE("conav-experiment draws the trade-off of pictures and moves", "[planner][experiment]") {
  const test::ProgramRunner desk("conav-experiment");
  const auto outcome = desk.Run(
      "tradeoff --seeds 1 --model glpf --operators careful,hasty --json t.json --csv t.csv --svg "
      "t.svg");
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.out,
             Contains("SIMULATED") && Contains("threshold") && Contains("IG-MCTS is better at"));
  const auto json = nlohmann::json::parse(ReadFile(desk / "t.json").value());
  CHECK(json.at("policies").size() == 12);
  const std::string csv = ReadFile(desk / "t.csv").value();
  CHECK_THAT(csv, Catch::StartsWith("policy,parameter,operator,seed,"));
  CHECK(test::CountOf(csv, "\n") == 1 + static_cast<int>(json.at("points").size()));
  const std::string plot = ReadFile(desk / "t.svg").value();
  CHECK_THAT(plot, Contains("simulated operator: hasty") && !Contains("nan") && !Contains("inf"));
  CHECK(test::XmlError(plot) == "");
}

TEST_CASE("conav-experiment refuses wrong use with 2 and says what is wrong",
          "[planner][experiment]") {
  const test::ProgramRunner desk("conav-experiment");
  CHECK(desk.Run("").exit_code == 2);
  CHECK(desk.Run("search --operators grumpy").exit_code == 2);
  CHECK(desk.Run("search --seeds 0").exit_code == 2);
  CHECK(desk.Run("--help").exit_code == 0);
  const auto refuses = [&](const std::string& arguments, const std::string& why) {
    CAPTURE(arguments);
    const auto outcome = desk.Run(arguments);
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.out.empty());
    CHECK_THAT(outcome.error, Contains(why));
  };
  refuses("sweep", "there is no experiment 'sweep'; there are search and tradeoff");
  refuses("search --first-seed -1", "--first-seed: '-1' is not a whole number");
  for (const std::string experiment : {"search ", "tradeoff "}) {
    refuses(experiment + "--preset round", "maze preset \"round\" is unknown");
    refuses(experiment + "--weights none.nhpm", "--weights none.nhpm: no such file");
    refuses(experiment + "--model glpf --weights none.nhpm", "--weights: --model glpf");
    refuses(experiment + "--variants-file none.yaml", "experiment: none.yaml: no such file");
  }
  for (const std::string option : {"search --variants best", "tradeoff --variant best"}) {
    refuses(option, "no variant best");
    refuses(option, "paper-literal");
  }
  REQUIRE(WriteFile(desk / "hello.yaml", "hello"));
  refuses("search --variants-file hello.yaml", "hello.yaml: no map search_variants");
  refuses("search --variants-file /proc", "/proc: cannot read: Is a directory");
}

TEST_CASE("an output that cannot be written is found before the work", "[planner][experiment]") {
  const test::ProgramRunner desk("conav-experiment");
  const auto outcome = desk.Run("search --json nowhere/s.json");
  CHECK(outcome.exit_code == 2);
  CHECK_THAT(outcome.error, Contains("nowhere"));
  CHECK_THAT(desk.Run("tradeoff --svg nowhere/t.svg").error, Contains("nowhere"));
  CHECK(desk.Run("tradeoff --json t.json --csv t.json").exit_code == 2);
}

}  // namespace
}  // namespace conav
