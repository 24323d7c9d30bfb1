#include <catch2/catch.hpp>

#include "planner/explain/decision_text.h"
#include "unit/planner/explain/sample_decision.h"

namespace conav::planner {
namespace {

TEST_CASE("leaves have rows of their own, by visits, and parents lie amid them",
          "[planner][explain]") {
  const TreeLayout layout = LayOut(SampleDecision(), 100, 10);
  REQUIRE(layout.nodes.size() == 5);
  CHECK(layout.rows == 3);
  CHECK(layout.depth == 2);
  CHECK(layout.nodes[0].row == 1.0);
  CHECK(layout.nodes[1].row == 0.0);  // east, 60 visits
  CHECK(layout.nodes[2].row == 1.0);  // west, 30, above its only child
  CHECK(layout.nodes[3].row == 1.0);
  CHECK(layout.nodes[3].parent == 2);
  CHECK(layout.nodes[4].row == 2.0);
}

TEST_CASE("the line of the action taken is marked", "[planner][explain]") {
  const TreeLayout east = LayOut(SampleDecision(), 100, 10);
  CHECK(east.nodes[0].on_line);
  CHECK(east.nodes[1].on_line);
  CHECK_FALSE(east.nodes[2].on_line);
  DecisionRecord decision = SampleDecision();
  decision.taken = {.target = {2, 1}};
  const TreeLayout west = LayOut(decision, 100, 10);
  CHECK_FALSE(west.nodes[1].on_line);
  CHECK(west.nodes[2].on_line);
  CHECK(west.nodes[3].on_line);  // the most visited below it
}

TEST_CASE("a tree is cut by visits and by depth", "[planner][explain]") {
  const TreeLayout few = LayOut(SampleDecision(), 3, 10);
  REQUIRE(few.nodes.size() == 3);
  CHECK(few.nodes[2].node == 2);
  CHECK(LayOut(SampleDecision(), 100, 1).nodes.size() == 4);
  CHECK(LayOut(SampleDecision(), 1, 10).nodes.size() == 1);
}

TEST_CASE("without a tree nothing is laid out", "[planner][explain]") {
  const TreeLayout layout = LayOut(SampleWithoutSearch(), 100, 10);
  CHECK(layout.nodes.empty());
  CHECK(layout.rows == 0);
}

}  // namespace
}  // namespace conav::planner
