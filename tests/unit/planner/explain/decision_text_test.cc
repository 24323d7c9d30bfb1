#include "planner/explain/decision_text.h"

#include <catch2/catch.hpp>

#include "unit/planner/explain/sample_decision.h"

namespace conav::planner {
namespace {

TEST_CASE("a decision is explained with its situation, its actions and the reason",
          "[planner][explain]") {
  const std::string text = DecisionText(SampleDecision());
  CHECK_THAT(text, Catch::Contains("decision 12 of r1 in w1 at 2.50 s, method ig-mcts\n"
                                   "cell (2,2), 1 goals left: (2,3); 2 cells since the last "
                                   "picture\noperator's map revision 3; guidance revision 2: 3 "
                                   "cells to (1,3)\n"));
  CHECK_THAT(text, Catch::Contains("search: 100 iterations, 70 nodes, 9 queries to nhpm (14 more "
                                   "looked up), 1.2 ms\n"));
  const auto taken = text.find("* move east to (2,3)");
  const auto other = text.find("  move west to (2,1)");
  REQUIRE(taken != std::string::npos);
  REQUIRE(other != std::string::npos);
  CHECK(taken < other);
  CHECK_THAT(text, Catch::Contains("60    101.00      100.00      0.00      1.00"));
  CHECK_THAT(text,
             Catch::Contains("picture to the west          not worth it: 0.06 cells expected"));
  CHECK_THAT(text, Catch::Contains("Taken: move east to (2,3)"));
}

TEST_CASE("without terms there is no column of them, without a search no table",
          "[planner][explain]") {
  DecisionRecord decision = SampleDecision();
  decision.report.has_terms = false;
  CHECK_THAT(DecisionText(decision),
             !Catch::Contains("smoothn.") && Catch::Contains("planner.search.report"));
  CHECK_THAT(DecisionText(SampleWithoutSearch()),
             Catch::Contains("command: move east to (2,3)\n") && !Catch::Contains("visits") &&
                 Catch::Contains("makes no search"));
  CHECK_THAT(DecisionText(SampleLowLevelAction()), Catch::Contains("command: low-level action\n"));
  CHECK(DecisionJson(SampleLowLevelAction()).at("taken") == "low-level action");
}

TEST_CASE("a list has a line for each decision", "[planner][explain]") {
  const DecisionSummary summaries[] = {Summarise(SampleDecision()), Summarise(SampleSnapshot(13)),
                                       Summarise(SampleWithoutSearch())};
  const std::string text = ListText(summaries);
  CHECK_THAT(text, Catch::Contains("(2,2)     move east to (2,3)            60 %    101.00"));
  CHECK_THAT(text, Catch::Contains("10.50\n"));
  CHECK_THAT(text, Catch::Contains("17.50  120.00 cells expected\n"));
  CHECK_THAT(text, Catch::Contains("no search\n"));
}

TEST_CASE("as JSON a decision holds all its figures", "[planner][explain]") {
  const auto json = DecisionJson(SampleDecision());
  CHECK(json.at("decision") == 12);
  CHECK(json.at("actions").size() == 4);
  CHECK(json.at("actions").at(0).at("taken") == true);
  CHECK(json.at("actions").at(1).at("terms").at("communication") == -3.5);
  CHECK(json.at("tree").size() == 5);
  CHECK(json.at("views").at(0).at("information_gain") == 3.5);
  CHECK(json.at("why").size() == 3);
  const auto without = DecisionJson(SampleWithoutSearch());
  CHECK(without.at("searched") == false);
  CHECK(without.at("actions").empty());
  const DecisionSummary summaries[] = {Summarise(SampleSnapshot(13))};
  CHECK(ListJson(summaries).at(0).at("picture") == true);
  CHECK(ListJson(summaries).at(0).at("margin") == 17.5);
}

}  // namespace
}  // namespace conav::planner
