#include "planner/explain/explanation.h"

#include <catch2/catch.hpp>

#include "unit/planner/explain/sample_decision.h"

namespace conav::planner {
namespace {

TEST_CASE("actions are ranked by visits", "[planner][explain]") {
  const auto actions = RankedActions(SampleDecision().report);
  REQUIRE(actions.size() == 4);
  CHECK(actions[0].visits == 60);
  CHECK(actions[1].visits == 30);
  CHECK(actions[2].visits == 10);
  CHECK(actions[3].visits == 0);
}

TEST_CASE("a move is explained by what the runner-up lacks and what a picture would cost",
          "[planner][explain]") {
  const DecisionRecord decision = SampleDecision();
  CHECK(Margin(decision) == 101.0 - 90.5);
  const auto why = Why(decision);
  REQUIRE(why.size() == 3);
  CHECK(why[0] == "Taken: move east to (2,3), visited 60 of 100 times, worth 101.00.");
  CHECK(why[1] ==
        "The runner-up, move west to (2,1) (30 visits), is worth 10.50 less, most by communication "
        "(-3.50) and goals (-3.00).");
  CHECK(why[2] ==
        "The best picture, to the north, was expected to change 2.75 cells of the operator's map "
        "and costs 12.00, its turn and the operator's path still ahead included. It is worth "
        "-9.25, 110.25 less than the move; it was not worth its cost.");
}

constexpr const char* kPriceOfPicture =
    "The picture was expected to change 120.00 cells of the operator's map and costs 12.00, its "
    "turn and the operator's path still ahead included.";

TEST_CASE("a picture is explained by its gain and its cost", "[planner][explain]") {
  const auto why = Why(SampleSnapshot(13));
  REQUIRE(why.size() == 3);
  CHECK(why[0] == "Taken: picture to the north, visited 60 of 100 times, worth 108.00.");
  CHECK(why[1] ==
        "The runner-up, move west to (2,1) (30 visits), is worth 17.50 less, most by information "
        "(-117.00) and progress (-2.00).");
  CHECK(why[2] == kPriceOfPicture);
}

TEST_CASE("a picture is also compared with the best move, where that is not the runner-up",
          "[planner][explain]") {
  DecisionRecord decision = SampleSnapshot(13);
  decision.report.actions[3].visits = 40;
  CHECK(Why(decision)[2] ==
        std::string(kPriceOfPicture) +
            " Moving on (move west to (2,1)) was worth 90.50: 17.50 less than the picture, most by "
            "information (-117.00) and progress (-2.00).");
  decision.report.actions[0].visits = decision.report.actions[1].visits = 0;
  CHECK(Why(decision)[2] == std::string(kPriceOfPicture) + " No move was tried.");
}

TEST_CASE("a runner-up with the higher mean is not hidden", "[planner][explain]") {
  DecisionRecord decision = SampleDecision();
  decision.report.actions[0].mean_value = 102.0;
  decision.report.actions[0].terms.goals = 108.5;
  CHECK(Margin(decision) == -1.0);
  CHECK_THAT(Why(decision)[1], Catch::Contains("is worth 1.00 more, most by goals (+8.50)") &&
                                   Catch::Contains("most visited action"));
}

TEST_CASE("without terms nothing is said of them", "[planner][explain]") {
  DecisionRecord decision = SampleDecision();
  decision.report.has_terms = false;
  CHECK(Why(decision)[1] == "The runner-up, move west to (2,1) (30 visits), is worth 10.50 less.");
}

TEST_CASE("where no picture was considered it is said why", "[planner][explain]") {
  DecisionRecord decision = SampleDecision();
  decision.report.actions[2].visits = 0;
  CHECK(Why(decision)[2] ==
        "No picture was considered: each promised too little, or less than it costs; 2.75 cells at "
        "most.");
  decision.report.actions.resize(2);
  CHECK(Why(decision)[2] ==
        "No picture was offered here: each was sent, and nothing changed since.");
}

TEST_CASE("an action alone has no runner-up", "[planner][explain]") {
  DecisionRecord decision = SampleDecision();
  decision.report.actions = {decision.report.actions[1]};
  decision.report.chosen = 0;
  CHECK(RunnerUp(decision) == nullptr);
  CHECK(Margin(decision) == 0.0);
  CHECK(Why(decision)[1] == "No other action was tried.");
}

TEST_CASE("a method that overrules the search is called so", "[planner][explain]") {
  DecisionRecord decision = SampleDecision();
  decision.taken = {.target = {2, 1}};
  CHECK_THAT(Why(decision)[0], Catch::StartsWith("Taken: move west to (2,1)") &&
                                   Catch::Contains("The search preferred move east to (2,3)"));
  decision.taken = {.target = {1, 2}};
  REQUIRE(Why(decision).size() == 1);
  CHECK_THAT(Why(decision)[0], Catch::Contains("is none of the search's actions"));
}

TEST_CASE("methods without a search say so", "[planner][explain]") {
  DecisionRecord decision = SampleWithoutSearch();
  REQUIRE(Why(decision).size() == 1);
  CHECK_THAT(Why(decision)[0], Catch::StartsWith("Method instruction makes no search"));
  decision.report.method = "ig-mcts";
  CHECK_THAT(Why(decision)[0], Catch::Contains("made room for another robot"));
  decision.taken.kind = CommandKind::kTransmitView;
  CHECK_THAT(Why(decision)[0], Catch::Contains("the communication policy wanted a picture"));
}

}  // namespace
}  // namespace conav::planner
