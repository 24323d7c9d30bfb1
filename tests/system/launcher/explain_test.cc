// A demo leaves its decisions, and conav explain says why.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>

#include "common/runtime/file.h"
#include "planner/explain/decision_file.h"
#include "support/program_runner.h"
#include "system/launcher/demo_run.h"

using conav::planner::DecisionRecord;
using conav::testing::DemoRun;

namespace {

std::vector<DecisionRecord> DecisionsOf(const DemoRun& demo) {
  std::vector<DecisionRecord> decisions;
  const auto torn = conav::planner::ReadDecisions(
      demo.RunFolder() / "decisions.pb.zst",
      [&](DecisionRecord&& decision) { decisions.push_back(std::move(decision)); });
  INFO(demo.Story());
  if (!torn) FAIL(torn.error().text);
  CHECK_FALSE(*torn);
  return decisions;
}

/// Without what wall time makes of it.
std::vector<DecisionRecord> WithoutTimes(std::vector<DecisionRecord> decisions) {
  for (DecisionRecord& decision : decisions) decision.report.duration_ms = 0.0;
  return decisions;
}

}  // namespace

TEST_CASE("a demo's pictures are explained", "[launcher][system]") {
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
  for (const conav::SearchAction& action : picture->report.actions) {
    CHECK(action.terms.Sum() == Approx(action.mean_value).epsilon(1e-9).margin(1e-9));
  }

  const conav::test::ProgramRunner desk("conav-explain");
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
  CHECK_THAT(conav::ReadFile(desk / "why.svg").value(), Catch::Contains("search tree: "));
}

TEST_CASE("the same seed gives the same recorded decisions", "[launcher][system]") {
  const auto play = [] {
    DemoRun demo({"--headless", "--seed", "11", "--camera", "none", "--perception", "embedded"});
    demo.EndsWell();
    return WithoutTimes(DecisionsOf(demo));
  };
  const auto first = play();
  CHECK(first == play());
  CHECK_FALSE(first.empty());
}

TEST_CASE("a run of a method without a search says that it has none", "[launcher][system]") {
  DemoRun demo({"--headless", "--seed", "7", "--camera", "none", "--method", "instruction"});
  demo.EndsWell();
  const conav::test::ProgramRunner desk("conav-explain");
  const auto explained = desk.Run(fmt::format("'{}' --decision 1", demo.RunFolder().string()));
  CHECK(explained.exit_code == 0);
  CHECK_THAT(explained.out, Catch::Contains("Method instruction makes no search"));
}
