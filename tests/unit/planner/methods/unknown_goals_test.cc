#include "planner/methods/unknown_goals.h"

#include <catch2/catch.hpp>
#include <utility>

using namespace conav;
using namespace conav::planner;

namespace {

Situation Guided(std::vector<Cell> path) {
  Situation situation;
  situation.guidance.emplace().path = std::move(path);
  return situation;
}

TEST_CASE("an answer that leads to no goal halves what the next one is worth",
          "[planner][unknown-goals]") {
  Situation situation = Guided({{1, 1}, {1, 2}});
  AnswerTrust trust;
  trust.Update(situation);
  CHECK(trust.value() == 1.0);
  trust.Asked();
  trust.Asked();
  trust.Asked();
  CHECK(trust.value() == 0.125);
  situation.state.goals_reached = {{5, 5}};  // found without the operator
  trust.Update(situation);
  CHECK(trust.value() == 0.125);
  situation.guidance.reset();  // the path ends at the goal that is reached now
  situation.state.goals_reached.push_back({1, 2});
  trust.Update(situation);
  CHECK(trust.value() == 1.0);
}

TEST_CASE("a goal reached before the operator's path came does not restore trust",
          "[planner][unknown-goals]") {
  AnswerTrust trust;
  trust.Asked();
  Situation situation = Guided({{1, 1}, {1, 2}});
  situation.state.goals_reached = {{1, 2}};  // before there was a path
  trust.Update(situation);
  trust.Update(situation);
  CHECK(trust.value() == 0.5);
}

TEST_CASE("a restarted world begins with trust", "[planner][unknown-goals]") {
  AnswerTrust trust;
  Situation situation = Guided({{1, 1}, {1, 2}});
  situation.state.goals_reached = {{5, 5}};
  trust.Update(situation);
  trust.Asked();
  situation.state.goals_reached.clear();
  trust.Update(situation);
  CHECK(trust.value() == 1.0);
}

}  // namespace
