#include <fmt/core.h>

#include <catch2/catch.hpp>

#include "planner/explain/decision_text.h"
#include "support/text.h"
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

TEST_CASE("it shows what the views promise, the tree with its figures, and why",
          "[planner][explain]") {
  const std::string svg = DecisionSvg(SampleDecision());
  for (const char* shown : {"picture from (2,1) to the north: information 3.50",
                            "picture from (2,2) to the north: information 2.75", "5 of 70 nodes",
                            "move west to (2,1): 30 visits", "90.50", "0.50",
                            "stroke-dasharray=\"5 3\"",  // may be blocked
                            "Taken: move east to (2,3)"}) {
    CHECK_THAT(svg, Catch::Contains(shown));
  }
  CHECK_THAT(svg, !Catch::Contains("picture from (2,2) to the west"));  // under 2 % of the most
}

TEST_CASE("rows and columns are numbered", "[planner][explain]") {
  const std::string svg = DecisionSvg(SampleDecision());
  const auto labels = [&](int number) {
    return test::CountOf(svg, fmt::format("fill=\"#666666\">{}</text>", number));
  };
  for (const int number : {0, 4}) CHECK(labels(number) == 2);
  CHECK(labels(5) == 0);
}

TEST_CASE("it says when there is no tree", "[planner][explain]") {
  CHECK_THAT(DecisionSvg(SampleWithoutSearch()), Catch::Contains("no search was made"));
  DecisionRecord decision = SampleDecision();
  decision.report.tree.clear();
  CHECK_THAT(DecisionSvg(decision), Catch::Contains("the tree was not recorded"));
}

TEST_CASE("it marks where the operator's map is wrong by the robot's own map",
          "[planner][explain]") {
  DecisionRecord decision = SampleDecision();
  const auto marks = [&] { return test::CountOf(DecisionSvg(decision), "#CC79A7"); };
  const int with_two = marks();
  decision.belief[{1, 1}] = 0.0F;
  CHECK(marks() == with_two - 2);  // a cross has two lines
  decision.belief[{0, 2}] = 1.0F;
  CHECK(marks() == with_two - 3);
  decision.belief[{3, 3}] = 1.0F;  // unknown to the robot
  CHECK(marks() == with_two - 3);
}

TEST_CASE("leaves have rows of their own, by visits, and parents lie amid them",
          "[planner][explain]") {
  const TreeLayout layout = LayOut(SampleDecision(), 100, 10);
  std::vector<double> rows;  // root, east (60 visits), west (30), its only child, the picture
  for (const PlacedNode& node : layout.nodes) rows.push_back(node.row);
  CHECK(rows == std::vector<double>{1.0, 0.0, 1.0, 1.0, 2.0});
  CHECK(layout.rows == 3);
  CHECK(layout.depth == 2);
  CHECK(layout.nodes[3].parent == 2);
}

TEST_CASE("the line of the action taken is marked, down to the most visited below it",
          "[planner][explain]") {
  const auto on_line = [](Cell taken) {
    DecisionRecord decision = SampleDecision();
    decision.taken = {.target = taken};
    std::vector<bool> marked;
    for (const PlacedNode& node : LayOut(decision, 100, 10).nodes) marked.push_back(node.on_line);
    return marked;
  };
  CHECK(on_line({2, 3}) == std::vector<bool>{true, true, false, false, false});
  CHECK(on_line({2, 1}) == std::vector<bool>{true, false, true, true, false});
}

TEST_CASE("a tree is cut by visits and by depth, without one nothing is laid out",
          "[planner][explain]") {
  const TreeLayout few = LayOut(SampleDecision(), 3, 10);
  REQUIRE(few.nodes.size() == 3);
  CHECK(few.nodes[2].node == 2);
  CHECK(LayOut(SampleDecision(), 100, 1).nodes.size() == 4);
  CHECK(LayOut(SampleDecision(), 1, 10).nodes.size() == 1);
  CHECK(LayOut(SampleWithoutSearch(), 100, 10).nodes.empty());
}

}  // namespace
}  // namespace conav::planner
