#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <string>

#include "common/runtime/file.h"
#include "support/program_runner.h"

namespace conav::statistics {
namespace {

const std::string kErgoStool =
    std::string(CONAV_TESTS_DIR) + "/unit/study/statistics/data/oracle_ergoStool.csv";

using Ended = test::ProgramOutcome;

Ended Run(const std::string& arguments) { return test::RunProgram("conav-stats", arguments); }

/// `text` in a file of `folder`.
std::string Written(const test::TemporaryFolder& folder, const std::string& text) {
  const auto path = folder / "t.csv";
  REQUIRE(WriteFile(path, text));
  return path.string();
}

TEST_CASE("conav stats prints tables and writes JSON and a page", "[operator][stats]") {
  const test::TemporaryFolder folder;
  const Ended ended = Run(fmt::format("{} --json {} --html {}", kErgoStool,
                                      (folder / "r.json").string(), (folder / "r.html").string()));
  INFO(ended.text());
  REQUIRE(ended.exit_code == 0);
  CHECK_THAT(ended.text(), Catch::StartsWith("oracle_ergoStool.csv: 9 subjects, 4 conditions"));
  CHECK_THAT(ended.text(), Catch::Contains("Greenhouse-Geisser  0.64592"));
  const auto json = nlohmann::json::parse(*ReadFile(folder / "r.json"));
  CHECK(json["anova"]["p"].get<double>() == Approx(3.9345638e-07));
  CHECK(json["sha256"] == "969b142037e41cb6cc4000a8b5b376be460980d3fdeb4b5a4a0428c243977438");
  CHECK_THAT(*ReadFile(folder / "r.html"), Catch::Contains("</svg>"));
}

TEST_CASE("A document on standard output is all that is there", "[operator][stats]") {
  const Ended json = Run(kErgoStool + " --json -");
  CHECK(json.exit_code == 0);
  CHECK(nlohmann::json::parse(json.out, nullptr, false)["alpha"] == 0.05);
  const Ended page = Run(kErgoStool + " --html -");
  CHECK_THAT(page.out, Catch::StartsWith("<!DOCTYPE html>"));
}

TEST_CASE("Option --alpha sets the confidence of intervals", "[operator][stats]") {
  const Ended ended = Run(kErgoStool + " --alpha 0.1");
  CHECK(ended.exit_code == 0);
  CHECK_THAT(ended.text(), Catch::Contains("90 % CI"));
}

TEST_CASE("Data that cannot be read ends with 1 and names file, line and column",
          "[operator][stats]") {
  const test::TemporaryFolder folder;
  const auto fails = [](const std::string& arguments, const std::string& message) {
    const Ended ended = Run(arguments);
    CHECK(ended.exit_code == 1);
    CHECK(ended.text() == "conav stats: " + message + "\n");
  };
  fails("/none.csv", "/none.csv: no such file");
  const std::string wrong = Written(folder, "subject,a,b\np1,1,2\np2,1,two\n");
  fails(wrong, wrong + ":3: column 'b': 'two' is not a number");
}

TEST_CASE("A file that cannot be written is wrong use, found before the data is read",
          "[operator][stats]") {
  const test::TemporaryFolder folder;
  const std::string nowhere = (folder / "none" / "r.json").string();
  const Ended ended = Run("/none.csv --json " + nowhere);
  CHECK(ended.exit_code == 2);
  CHECK(ended.text() == "conav stats: --json " + nowhere + ": cannot write: there is no folder " +
                            std::filesystem::path(nowhere).parent_path().string() + "\n");
}

TEST_CASE("A subject that is left out is named on the way to a result", "[operator][stats]") {
  const test::TemporaryFolder folder;
  const Ended ended = Run(Written(folder, "subject,a,b\np1,1,2\np2,,1\np3,4,1\n"));
  CHECK(ended.exit_code == 0);
  CHECK_THAT(ended.text(),
             Catch::Contains("Note: Subject p2 (line 3) is left out: no value in a."));
}

TEST_CASE("Wrong use ends with 2 and writes nothing", "[operator][stats]") {
  const test::TemporaryFolder folder;
  const std::string data = Written(folder, "subject,a,b\np1,1,2\np2,2,1\n");
  for (const std::string& wrong :
       {std::string(), data + " --alpha 0", data + " --alpha 1", data + " --alpha x",
        data + " --colour", data + " " + data, data + " --json - --html -",
        fmt::format("{0} --json {1} --html {1}", data, (folder / "r").string()),
        fmt::format("{0} --json {0}", data), fmt::format("{0} --html {0}", data)}) {
    INFO(wrong);
    CHECK(Run(wrong).exit_code == 2);
  }
  CHECK_FALSE(std::filesystem::exists(folder / "r"));
  CHECK_THAT(*ReadFile(data), Catch::StartsWith("subject,a,b"));
  CHECK(Run(fmt::format("{0} --json {0}", data)).text() ==
        fmt::format("conav stats: --json {}: is the input FILE, too\n", data));
}

TEST_CASE("Option --help says what each figure is", "[operator][stats]") {
  const Ended ended = Run("--help");
  CHECK(ended.exit_code == 0);
  for (const char* part : {"subject,teleoperation", "Cousineau-Morey", "Greenhouse-Geisser",
                           "generalised eta^2", "Holm", "d_z", "Kendall's W", "Exit codes"}) {
    CHECK_THAT(ended.text(), Catch::Contains(part));
  }
}

}  // namespace
}  // namespace conav::statistics
