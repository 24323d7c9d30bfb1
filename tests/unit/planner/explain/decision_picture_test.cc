#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>

#include "planner/explain/decision_text.h"
#include "support/xml_check.h"
#include "unit/planner/explain/sample_decision.h"

namespace conav::planner {
namespace {

TEST_CASE("the picture is well-formed, whatever was recorded", "[planner][explain]") {
  DecisionRecord bare = SampleDecision();
  bare.report.tree.clear();
  bare.report.views.clear();
  bare.guidance.clear();
  bare.plan.clear();
  DecisionRecord odd = SampleDecision();
  odd.report.robot = "<r&1>";
  for (const DecisionRecord& decision : {SampleDecision(), SampleSnapshot(3), SampleWithoutSearch(),
                                         SampleLowLevelAction(), bare, odd}) {
    CHECK(test::XmlError(DecisionSvg(decision)) == "");
  }
}

TEST_CASE("it shows the information gain of each view that promises something",
          "[planner][explain]") {
  const std::string svg = DecisionSvg(SampleDecision());
  CHECK_THAT(svg, Catch::Contains("picture from (2,1) to the north: 3.50 cells expected"));
  CHECK_THAT(svg, Catch::Contains("picture from (2,2) to the north: 2.75 cells expected"));
  CHECK_THAT(svg, !Catch::Contains("picture from (2,2) to the west"));  // under 2 % of the most
  CHECK_THAT(svg, Catch::Contains("the longest: 3.50 cells expected"));
}

TEST_CASE("rows and columns are numbered", "[planner][explain]") {
  const DecisionRecord decision = SampleDecision();
  const std::string svg = DecisionSvg(decision);
  const auto labels = [&](int number) {
    const std::string label = fmt::format("fill=\"#666666\">{}</text>", number);
    int count = 0;
    for (auto at = svg.find(label); at != std::string::npos; at = svg.find(label, at + 1)) ++count;
    return count;
  };
  CHECK(labels(0) == 2);
  CHECK(labels(decision.map.rows() - 1) >= 1);
  CHECK(labels(decision.map.columns() - 1) >= 1);
  CHECK(labels(std::max(decision.map.rows(), decision.map.columns())) == 0);
}

TEST_CASE("it shows the tree with its figures, and why", "[planner][explain]") {
  const std::string svg = DecisionSvg(SampleDecision());
  CHECK_THAT(svg, Catch::Contains("5 of 70 nodes"));
  CHECK_THAT(svg, Catch::Contains("move west to (2,1): 30 visits, value 90.50, feasible 0.50"));
  CHECK_THAT(svg, Catch::Contains("stroke-dasharray=\"5 3\""));  // may be blocked
  CHECK_THAT(svg, Catch::Contains("Taken: move east to (2,3)"));
}

TEST_CASE("it says when there is no tree", "[planner][explain]") {
  CHECK_THAT(DecisionSvg(SampleWithoutSearch()), Catch::Contains("no search was made"));
  DecisionRecord decision = SampleDecision();
  decision.report.tree.clear();
  CHECK_THAT(DecisionSvg(decision), Catch::Contains("the tree was not recorded"));
}

TEST_CASE("it marks where the operator's map is wrong, as far as the robot knows",
          "[planner][explain]") {
  DecisionRecord decision = SampleDecision();
  const auto count = [](const std::string& svg, std::string_view part) {
    std::size_t found = 0;
    for (auto at = svg.find(part); at != svg.npos; at = svg.find(part, at + 1)) ++found;
    return found;
  };
  constexpr const char* kMistake = "#CC79A7";
  const auto with_two = count(DecisionSvg(decision), kMistake);
  decision.belief[{1, 1}] = 0.0F;
  CHECK(count(DecisionSvg(decision), kMistake) == with_two - 2);  // a cross has two lines
  decision.belief[{0, 2}] = 1.0F;
  CHECK(count(DecisionSvg(decision), kMistake) == with_two - 3);
  decision.belief[{3, 3}] = 1.0F;  // unknown to the robot
  CHECK(count(DecisionSvg(decision), kMistake) == with_two - 3);
}

}  // namespace
}  // namespace conav::planner
