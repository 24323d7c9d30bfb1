// conav-explain as its users see it.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "planner/explain/decision_file.h"
#include "support/program_runner.h"
#include "support/xml_check.h"
#include "unit/planner/explain/sample_decision.h"

namespace conav::planner {
namespace {

DecisionRecord Of(const std::string& robot, DecisionRecord decision) {
  decision.report.robot = robot;
  return decision;
}

/// A run folder `run` with the decisions 12 and 13 of r1, the second a picture, and others of r2.
class ExplainBench : public test::ProgramRunner {
 public:
  explicit ExplainBench(const std::vector<DecisionRecord>& others = {})
      : ProgramRunner("conav-explain") {
    std::filesystem::create_directories(*this / "run");
    auto log = DecisionLog::Open(file());
    REQUIRE(log);
    REQUIRE(log->Append(SampleDecision()));
    REQUIRE(log->Append(SampleSnapshot(13)));
    for (const DecisionRecord& other : others) REQUIRE(log->Append(other));
  }
  std::filesystem::path file() const { return *this / "run/decisions.pb.zst"; }
};

TEST_CASE("conav explain lists the decisions of a run", "[planner][explain]") {
  const ExplainBench bench;
  const auto all = bench.Run("run");
  CHECK(all.exit_code == 0);
  CHECK_THAT(all.out, Catch::Contains("move east to (2,3)"));
  CHECK_THAT(all.out, Catch::Contains("picture to the north"));
  const auto snapshots = bench.Run("run --pictures --json -");
  CHECK(snapshots.exit_code == 0);
  const auto json = nlohmann::json::parse(snapshots.out);
  REQUIRE(json.size() == 1);
  CHECK(json[0].at("decision") == 13);
  CHECK_THAT(snapshots.error, Catch::Contains("picture to the north"));
  CHECK_THAT(bench.Run("run --decision 1..12").out, !Catch::Contains("picture"));
  CHECK(bench.Run("run/decisions.pb.zst").out == all.out);
}

TEST_CASE("conav explain explains one decision and draws it", "[planner][explain]") {
  const ExplainBench bench;
  const auto one = bench.Run("run --decision 13 --svg why.svg --json why.json");
  INFO(one.text());
  CHECK(one.exit_code == 0);
  CHECK_THAT(one.out, Catch::Contains("Taken: picture to the north"));
  const std::string svg = ReadFile(bench / "why.svg").value();
  CHECK(test::XmlError(svg) == "");
  const auto json = nlohmann::json::parse(ReadFile(bench / "why.json").value());
  CHECK(json.at("decision") == 13);
  CHECK(bench.Run("run --decision 13 --svg -").out == svg);
}

TEST_CASE("with several robots it wants to know which", "[planner][explain]") {
  const ExplainBench bench({Of("r2", SampleDecision())});
  const auto unclear = bench.Run("run --decision 12");
  CHECK(unclear.exit_code == 2);
  CHECK_THAT(unclear.error, Catch::Contains("--robot"));
  CHECK_THAT(bench.Run("run --decision 12 --robot r2").out, Catch::StartsWith("decision 12 of r2"));
  CHECK(bench.Run("run --decision 13").exit_code == 0);  // only r1 has it
}

TEST_CASE("several planners' files make one run, of decisions with one number the last is shown",
          "[planner][explain]") {
  const ExplainBench bench({SampleSnapshot(12)});
  const auto one = bench.Run("run --decision 12");
  CHECK(one.exit_code == 0);
  CHECK_THAT(one.error, Catch::Contains("2 of"));
  CHECK_THAT(one.out, Catch::Contains("Taken: picture"));
  auto other = DecisionLog::Open(bench / "run/decisions-planner-2.pb.zst");
  REQUIRE(other);
  REQUIRE(other->Append(Of("r2", SampleDecision())));
  CHECK(bench.Run("run --robot r2 --decision 12").exit_code == 0);
}

TEST_CASE("a missing run, robot or decision is named, with those that exist",
          "[planner][explain]") {
  const ExplainBench bench;
  const auto fails = [&](const std::string& arguments) {
    const auto outcome = bench.Run(arguments);
    CHECK(outcome.exit_code == 1);
    CHECK(outcome.out.empty());
    return outcome.error;
  };
  for (const auto& [arguments, named] : std::vector<std::pair<const char*, const char*>>{
           {"run --decision 14", "r1 12..13"},
           {"run --robot r7", "r1 12..13"},
           {"run --robot r1 --decision 1..5", "r1 12..13"},
           {"run --decision 12 --pictures", "picture"}}) {
    CHECK_THAT(fails(arguments), Catch::Contains(named));
  }
  std::filesystem::remove(bench.file());
  CHECK_THAT(fails("run"), Catch::Contains("run"));
}

TEST_CASE("a damaged file is refused, one that was cut off is read up to there",
          "[planner][explain]") {
  const ExplainBench bench;
  std::filesystem::resize_file(bench.file(), std::filesystem::file_size(bench.file()) - 3);
  const auto cut = bench.Run("run");
  CHECK(cut.exit_code == 0);
  CHECK_THAT(cut.out, Catch::Contains("move east to (2,3)") && !Catch::Contains("picture"));
  CHECK_THAT(cut.error, Catch::Contains("decisions.pb.zst"));
  REQUIRE(WriteFile(bench.file(), "something else"));
  const auto damaged = bench.Run("run");
  CHECK(damaged.exit_code == 1);
  CHECK_THAT(damaged.error, Catch::Contains("decisions.pb.zst"));
}

TEST_CASE("wrong use is exit code 2", "[planner][explain]") {
  const ExplainBench bench;
  for (const char* wrong :
       {"", "run --decision x", "run --svg a.svg", "run --decision 12 --svg - --json -",
        "run --decision 12 --svg nowhere/a.svg"}) {
    CHECK(bench.Run(wrong).exit_code == 2);
  }
  CHECK(bench.Run("--help").exit_code == 0);
}

}  // namespace
}  // namespace conav::planner
