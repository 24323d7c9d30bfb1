#include "planner/explain/explanation.h"

#include <catch2/catch.hpp>
#include <numbers>

#include "unit/planner/explain/sample_decision.h"

namespace conav::planner {
namespace {

constexpr double kQuarter = std::numbers::pi / 2.0;

TEST_CASE("headings have the compass's names where they have one, actions those of where they lead",
          "[planner][explain]") {
  for (const auto& [quarters, name] :
       std::vector<std::pair<double, const char*>>{{0.0, "east"},
                                                   {0.5, "north-east"},
                                                   {1.0, "north"},
                                                   {-1.0, "south"},
                                                   {3.5, "south-east"},
                                                   {4.0, "east"},
                                                   {1.0 / 3.0, "30 degrees"}}) {
    CHECK(HeadingName(quarters * kQuarter) == name);
  }
  CHECK(ActionName({.target = {1, 2}}, {2, 2}) == "move north to (1,2)");
  CHECK(ActionName({.target = {2, 1}}, {2, 2}) == "move west to (2,1)");
  CHECK(ActionName({.target = {7, 7}}, {2, 2}) == "move to (7,7)");
  CHECK(ActionName({.kind = CommandKind::kTransmitView, .heading_rad = kQuarter}, {2, 2}) ==
        "picture to the north");
}

TEST_CASE("moves are the same by target, pictures by heading", "[planner][explain]") {
  const SearchAction move{.target = {1, 2}, .heading_rad = 1.0};
  const SearchAction view{.kind = CommandKind::kTransmitView, .heading_rad = 0.0};
  CHECK(IsSameCommand(move, {.target = {1, 2}}));
  CHECK_FALSE(IsSameCommand(move, {.target = {1, 3}}));
  CHECK(IsSameCommand(
      view, {.kind = CommandKind::kTransmitView, .target = {1, 1}, .heading_rad = 4.0 * kQuarter}));
  CHECK_FALSE(IsSameCommand(view, move));
}

TEST_CASE("a decision or a range of them is read, anything else is refused", "[planner][explain]") {
  const auto one = ParseDecisionRange("12").value();
  CHECK(one.is_one());
  CHECK((one.Contains(12) && !one.Contains(11)));
  const auto several = ParseDecisionRange("12..20").value();
  CHECK_FALSE(several.is_one());
  CHECK((several.Contains(12) && several.Contains(20) && !several.Contains(21)));
  for (const char* text :
       {"", "0", "-1", "x", "3x", "20..12", "1..", "..2", "1...2", "1-2", "99999999999999999999"}) {
    const auto range = ParseDecisionRange(text);
    REQUIRE_FALSE(range);
    CHECK_THAT(range.error().text, Catch::Contains(text));
  }
}

TEST_CASE("actions are ranked by visits", "[planner][explain]") {
  std::vector<std::uint32_t> visits;
  for (const auto& action : RankedActions(SampleDecision().report)) visits.push_back(action.visits);
  CHECK(visits == std::vector<std::uint32_t>{60, 30, 10, 0});
}

/// That sentence `i` of why says all of `parts`.
void CheckWhy(const DecisionRecord& decision, std::size_t i,
              const std::vector<const char*>& parts) {
  const auto why = Why(decision);
  REQUIRE(i < why.size());
  for (const char* part : parts) CHECK_THAT(why[i], Catch::Contains(part));
}

TEST_CASE("a move is explained by what the runner-up lacks and what a picture would cost",
          "[planner][explain]") {
  DecisionRecord decision = SampleDecision();
  CHECK(Margin(decision) == 101.0 - 90.5);
  CHECK(Why(decision).size() == 3);
  CheckWhy(decision, 0, {"Taken: move east to (2,3)", "60 of 100 times", "worth 101.00"});
  CheckWhy(decision, 1,
           {"runner-up, move west to (2,1) (30 visits)", "10.50 less",
            "communication (-3.50) and goals (-3.00)"});
  CheckWhy(decision, 2,
           {"best picture, to the north", "worth 2.75", "costs 12.00", "worth -9.25, 110.25 less",
            "not worth its cost"});
  decision.report.has_terms = false;
  CHECK_THAT(Why(decision)[1], Catch::Contains("10.50 less") && !Catch::Contains("most by"));
}

TEST_CASE("a picture is explained by its gain, its cost and the best move", "[planner][explain]") {
  DecisionRecord decision = SampleSnapshot(13);
  CHECK(Why(decision).size() == 3);
  CheckWhy(decision, 0, {"Taken: picture to the north", "60 of 100 times", "worth 108.00"});
  CheckWhy(decision, 1, {"17.50 less", "information (-117.00) and progress (-2.00)"});
  CheckWhy(decision, 2, {"worth 120.00", "costs 12.00"});
  CHECK_THAT(Why(decision)[2], !Catch::Contains("Moving on"));  // the move is the runner-up
  decision.report.actions[3].visits = 40;
  CheckWhy(
      decision, 2,
      {"Moving on (move west to (2,1)) was worth 90.50", "17.50 less", "information (-117.00)"});
  decision.report.actions[0].visits = decision.report.actions[1].visits = 0;
  CheckWhy(decision, 2, {"No move was tried"});
}

TEST_CASE("a runner-up with the higher mean is not hidden", "[planner][explain]") {
  DecisionRecord decision = SampleDecision();
  decision.report.actions[0].mean_value = 102.0;
  decision.report.actions[0].terms.goals = 108.5;
  CHECK(Margin(decision) == -1.0);
  CheckWhy(decision, 1, {"1.00 more, most by goals (+8.50)", "most visited action"});
}

TEST_CASE("what there is none of is said", "[planner][explain]") {
  DecisionRecord decision = SampleDecision();
  decision.report.actions[2].visits = 0;
  CheckWhy(decision, 2, {"No picture was considered", "2.75 at most"});
  decision.report.actions.resize(2);
  CheckWhy(decision, 2, {"No picture was offered"});
  decision.report.actions = {decision.report.actions[1]};
  decision.report.chosen = 0;
  CHECK(RunnerUp(decision) == nullptr);
  CHECK(Margin(decision) == 0.0);
  CheckWhy(decision, 1, {"No other action was tried"});
}

TEST_CASE("a method that overrules the search, or makes none, says so", "[planner][explain]") {
  DecisionRecord decision = SampleDecision();
  decision.taken = {.target = {2, 1}};
  CheckWhy(decision, 0, {"Taken: move west to (2,1)", "preferred move east to (2,3)"});
  decision.taken = {.target = {1, 2}};
  CHECK(Why(decision).size() == 1);
  CheckWhy(decision, 0, {"none of the search's actions"});
  decision = SampleWithoutSearch();
  CHECK(Why(decision).size() == 1);
  CheckWhy(decision, 0, {"Method instruction makes no search"});
  decision.report.method = "ig-mcts";
  CheckWhy(decision, 0, {"made room for another robot"});
  decision.taken.kind = CommandKind::kTransmitView;
  CheckWhy(decision, 0, {"the communication policy wanted a picture"});
}

}  // namespace
}  // namespace conav::planner
