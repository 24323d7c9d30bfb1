// A demo leaves its decisions, and conav explain says why.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>

#include "common/runtime/file.h"
#include "planner/explain/decision_file.h"
#include "support/program_runner.h"
#include "system/launcher/demo_run.h"

namespace conav::testing {
namespace {

using planner::DecisionRecord;

std::vector<DecisionRecord> DecisionsOf(const DemoRun& demo) {
  std::vector<DecisionRecord> decisions;
  const auto torn = planner::ReadDecisions(
      demo.RunFolder() / "decisions.pb.zst",
      [&](DecisionRecord&& decision) { decisions.push_back(std::move(decision)); });
  INFO(demo.Story());
  if (!torn) FAIL(torn.error().text);
  CHECK_FALSE(*torn);
  return decisions;
}

}  // namespace

TEST_CASE("a demo's pictures are explained", "[demo]") {
  DemoRun demo({"--headless", "--seed", "7", "--camera", "none"});
  const auto result = demo.EndsWell();
  const auto decisions = DecisionsOf(demo);
  CHECK(decisions.size() == result.at("robots").at(0).at("decisions"));
  const auto picture =
      std::find_if(decisions.begin(), decisions.end(),
                   [](const DecisionRecord& decision) { return decision.sends_picture(); });
  REQUIRE(picture != decisions.end());
  CHECK(picture->report.has_terms);
  CHECK_FALSE(picture->report.tree.empty());
  CHECK_FALSE(picture->report.views.empty());
  for (const SearchAction& action : picture->report.actions) {
    CHECK(action.terms.Sum() == Approx(action.mean_value).epsilon(1e-9).margin(1e-9));
  }

  const test::ProgramRunner desk("conav-explain");
  const std::string run = demo.RunFolder().string();
  const auto listed = desk.Run(fmt::format("'{}' --pictures", run));
  INFO(listed.text());
  CHECK(listed.exit_code == 0);
  CHECK(std::count(listed.out.begin(), listed.out.end(), '\n') ==
        1 + std::count_if(decisions.begin(), decisions.end(),
                          [](const DecisionRecord& decision) { return decision.sends_picture(); }));
  const auto explained =
      desk.Run(fmt::format("'{}' --decision {} --svg why.svg", run, picture->report.decision));
  INFO(explained.text());
  CHECK(explained.exit_code == 0);
  CHECK_THAT(explained.out, Catch::Contains("Taken: picture to the ") &&
                                Catch::Contains("The picture was expected to change"));
  CHECK_THAT(ReadFile(desk / "why.svg").value(), Catch::Contains("search tree: "));
}

TEST_CASE("the same seed gives the same recorded decisions", "[demo]") {
  const auto play = [] {
    DemoRun demo({"--headless", "--seed", "11", "--camera", "none", "--perception", "embedded"});
    demo.EndsWell();
    auto decisions = DecisionsOf(demo);
    for (DecisionRecord& decision : decisions) decision.report.duration_ms = 0.0;
    return decisions;
  };
  const auto first = play();
  CHECK(first == play());
  CHECK_FALSE(first.empty());
}

}  // namespace conav::testing
