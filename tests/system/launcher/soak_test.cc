#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "support/running_program.h"
#include "support/temporary_folder.h"
#include "support/test_domain.h"

namespace conav::testing {
namespace {

/// The object of --json of a soak that ran its time without a violation.
nlohmann::json Soak(const std::string& arguments, std::chrono::seconds limit) {
  const test::TemporaryFolder folder;
  const std::string json = (folder / "result.json").string();
  test::RunningProgram soak(
      "conav",
      fmt::format("soak --domain {} --out '{}' --json '{}' {}", test::TestDomain(),
                  (folder / "runs").string(), json, arguments),
      folder / "output.txt");
  const launcher::ProcessEnd end = soak.Wait(limit);
  INFO(soak.Output());
  CHECK(end.Describe() == "exit code 0");
  auto result = nlohmann::json::parse(ReadFile(json).value_or("null"));
  REQUIRE(result.is_object());
  CHECK(result["ended"].get<std::string>().find("time limit") != std::string::npos);
  CHECK(result["violations"].empty());
  CHECK(result["metrics"]["violations"] == 0);
  for (const char* counted : {"moves", "goals", "edits", "stops", "page_bytes"}) {
    CAPTURE(counted);
    CHECK(result["metrics"][counted] > 0);
  }
  CHECK(result["processes"].size() >= 7);
  return result;
}

}  // namespace

TEST_CASE("whatever is killed, no edit is lost and no robot does what it must not", "[soak]") {
  const auto result = Soak("--hours 0.034 --robots 4 --kill-every 4 --preset open21 --camera none",
                           std::chrono::minutes(4));
  CHECK(result["metrics"]["rss_slope_mb_per_h"].is_null());  // too short to say
}

// Of its own in ctest: `./conav test -L long`.
TEST_CASE("the same for ten minutes with pictures", "[.long]") {
  const auto result = Soak("--hours 0.1667 --robots 8 --kill-every 15", std::chrono::minutes(15));
  CHECK(result["metrics"]["frames"] > 0);
}

}  // namespace conav::testing
