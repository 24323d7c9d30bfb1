
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/runtime/file.h"
#include "support/program_runner.h"
#include "unit/study/statistics/reference_tables.h"

namespace conav::statistics {
namespace {

TEST_CASE("conav stats prints tables and writes JSON and a page", "[statistics]") {
  const test::ProgramRunner stats("conav-stats");
  const std::string data = ReferencePath("ergoStool");
  const auto ended = stats.Run(data + " --json r.json --html r.html --alpha 0.1 --equivalence 0.2");
  INFO(ended.text());
  REQUIRE(ended.exit_code == 0);
  CHECK_THAT(ended.out,
             Catch::StartsWith("oracle_ergoStool.csv: 9 subjects") && Catch::Contains("90 % CI"));
  const auto json = nlohmann::json::parse(*ReadFile(stats / "r.json"));
  CHECK(json["anova"]["p"].get<double>() == Approx(3.9345638e-07));
  CHECK(json["pairs"][2]["equivalence"]["equivalent"] == true);
  CHECK_THAT(ended.out, Catch::Contains("T1 / T4"));
  CHECK(json["sha256"] == "969b142037e41cb6cc4000a8b5b376be460980d3fdeb4b5a4a0428c243977438");
  CHECK_THAT(*ReadFile(stats / "r.html"), Catch::Contains("</svg>"));
  // A document on standard output is all that is there.
  CHECK(nlohmann::json::parse(stats.Run(data + " --json -").out, nullptr, false)["alpha"] == 0.05);
  CHECK_THAT(stats.Run(data + " --html -").out, Catch::StartsWith("<!DOCTYPE html>"));
}

TEST_CASE("Data that cannot be used ends with 1, wrong use with 2, and nothing is written over",
          "[statistics]") {
  const test::ProgramRunner stats("conav-stats");
  REQUIRE(WriteFile(stats / "t.csv", "subject,a,b\np1,1,2\np2,2,1\n"));
  REQUIRE(WriteFile(stats / "wrong.csv", "subject,a,b\np1,1,2\np2,1,two\n"));
  const auto wrong = stats.Run("wrong.csv");
  CHECK(wrong.exit_code == 1);
  CHECK_THAT(wrong.error, Catch::Contains("wrong.csv:3: column 'b'"));
  for (const char* use :
       {"t.csv --alpha 0", "t.csv --alpha nan", "t.csv --equivalence nan", "t.csv --alpha 1",
        "t.csv t.csv", "t.csv --json - --html -", "t.csv --json r --html r", "t.csv --json t.csv",
        "t.csv --html t.csv", "t.csv --json none/r"}) {
    INFO(use);
    CHECK(stats.Run(use).exit_code == 2);
  }
  CHECK_FALSE(std::filesystem::exists(stats / "r"));
  CHECK_THAT(*ReadFile(stats / "t.csv"), Catch::StartsWith("subject,a,b"));
}

}  // namespace
}  // namespace conav::statistics
