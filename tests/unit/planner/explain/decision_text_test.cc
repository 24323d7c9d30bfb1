#include "planner/explain/decision_text.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "planner/explain/explanation.h"
#include "unit/planner/explain/sample_decision.h"

namespace conav::planner {
namespace {

TEST_CASE("a decision is explained with its situation, its actions and the reason",
          "[planner][explain]") {
  const std::string text = DecisionText(SampleDecision());
  for (const char* shown :
       {"decision 12", "r1", "w1", "2.50 s", "ig-mcts", "(2,2)", "(1,3)", "100 iterations",
        "70 nodes", "9 queries", "14 more", "nhpm", "1.2 ms", "information 0.06", "-3.50"}) {
    CHECK_THAT(text, Catch::Contains(shown));
  }
  const auto taken = text.find("* move east to (2,3)");
  const auto other = text.find("  move west to (2,1)");
  REQUIRE(taken != std::string::npos);
  REQUIRE(other != std::string::npos);
  CHECK(taken < other);
  CHECK_THAT(text.substr(taken, other - taken),
             Catch::Contains("60    101.00      100.00      0.00      1.00"));
  for (const std::string& why : Why(SampleDecision())) CHECK_THAT(text, Catch::Contains(why));
}

TEST_CASE("without terms there is no column of them, without a search no table",
          "[planner][explain]") {
  DecisionRecord decision = SampleDecision();
  decision.report.has_terms = false;
  CHECK_THAT(DecisionText(decision), !Catch::Contains("-3.50"));
  CHECK_THAT(DecisionText(SampleWithoutSearch()),
             Catch::Contains("move east to (2,3)") && !Catch::Contains("visits"));
  CHECK_THAT(DecisionText(SampleLowLevelAction()), Catch::Contains("low-level action"));
  CHECK(DecisionJson(SampleLowLevelAction()).at("taken") == "low-level action");
}

TEST_CASE("a list has a line for each decision", "[planner][explain]") {
  const DecisionSummary summaries[] = {Summarise(SampleDecision()), Summarise(SampleSnapshot(13)),
                                       Summarise(SampleWithoutSearch())};
  const std::string text = ListText(summaries);
  for (const char* shown : {"(2,2)", "60 %    101.00", "10.50", "17.50", "120.00", "no search"}) {
    CHECK_THAT(text, Catch::Contains(shown));
  }
  CHECK(std::count(text.begin(), text.end(), '\n') == 1 + 3);
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
