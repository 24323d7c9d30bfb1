// The supervision study in small: real processes, real DDS, real MuJoCo.
#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/runtime/file.h"
#include "support/program_desk.h"
#include "support/test_domain.h"

namespace conav::test {
namespace {

/// A desk whose programs keep to the test's domain.
struct SupervisionDesk {
  SupervisionDesk() { setenv("CONAV_DOMAIN", std::to_string(TestDomain()).c_str(), 1); }
  ~SupervisionDesk() { unsetenv("CONAV_DOMAIN"); }

  ProgramDesk desk{"conav-study"};
};

TEST_CASE("two robots and one operator: every trial is measured and every file is there",
          "[study][supervision][system]") {
  const SupervisionDesk bench;
  const ProgramOutcome study = bench.desk.Run(
      "--supervision --robots 2 --orders priority,fifo --seeds 2 --minutes 0.7 --speed 10 "
      "--interaction-times picture=3,blocked=3,path=3,log_sd=0 --out out --json result.json");
  INFO(study.text());
  REQUIRE(study.exit_code == 0);
  CHECK_THAT(study.out, Catch::Contains("SIMULATED operator") && Catch::Contains("2 priority") &&
                            Catch::Contains("M/M/1//N"));
  const auto json = nlohmann::json::parse(ReadFile(bench.desk / "result.json").value());
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
    CHECK(std::filesystem::file_size(bench.desk / ("out/" + std::string(file))) > 100);
  }
}

TEST_CASE("wrong use of the supervision study is refused by name", "[study][supervision][system]") {
  const SupervisionDesk bench;
  const ProgramOutcome unknown = bench.desk.Run("--supervision --orders lifo");
  CHECK(unknown.exit_code == 2);
  CHECK_THAT(unknown.error, Catch::Contains("--orders: lifo is unknown"));
  CHECK(bench.desk.Run("--supervision --interaction-times look=3").exit_code == 2);
  CHECK(bench.desk.Run("--supervision --robots 0").exit_code == 2);
  const ProgramOutcome help = bench.desk.Run("--supervision --help");
  CHECK(help.exit_code == 0);
  CHECK_THAT(help.out, Catch::Contains("--interaction-times"));
}

TEST_CASE("a folder that cannot be made fails before anything runs",
          "[study][supervision][system]") {
  const SupervisionDesk bench;
  const ProgramOutcome study = bench.desk.Run("--supervision --seeds 1 --out /proc/none");
  CHECK(study.exit_code == 1);
  CHECK_THAT(study.error, Catch::Contains("/proc/none: cannot make this folder"));
}

}  // namespace
}  // namespace conav::test
