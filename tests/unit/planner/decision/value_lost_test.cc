#include <catch2/catch.hpp>
#include <cmath>

#include "planner/decision/method.h"

using namespace conav;
using namespace conav::planner;

namespace {

/// A corridor of 1 x 8 cells, the robot at its western end.
Situation Corridor(std::vector<Cell> goals) {
  Situation situation;
  situation.state.cell = {0, 0};
  situation.state.goals_left = std::move(goals);
  situation.state.path = {{0, 0}};
  situation.map = {{}, 2.0, OccupancyGrid(1, 8, Occupancy::kFree)};
  return situation;
}

const ValueLostOptions kOptions{.reward = {}, .discount = 0.9, .answer_timeout_s = 0.0};

}  // namespace

TEST_CASE("the tour's return by hand: nearest goal first, unknown cells are free",
          "[planner][value]") {
  // steps: -1, +100 (goal at 2), -1, +100 (goal at 4)
  const double expected = -1.0 + 0.9 * 100.0 - 0.81 + 0.729 * 100.0;
  CHECK(TourReturn(Corridor({{0, 4}, {0, 2}}), kOptions) == Approx(expected));
  CHECK(TourReturn(Corridor({}), kOptions) == 0.0);
  Situation situation = Corridor({{0, 2}});
  situation.map.cells[{0, 1}] = Occupancy::kOccupied;
  CHECK(TourReturn(situation, kOptions) == 0.0);
  situation.map.cells[{0, 1}] = Occupancy::kUnknown;
  CHECK(TourReturn(situation, kOptions) == Approx(-1.0 + 90.0));
}

TEST_CASE("standing loses what a period of delay costs the tour", "[planner][value]") {
  const Situation situation = Corridor({{0, 2}});
  // (1 - 0.9) * 89 + 1 per 2.5 s
  CHECK(ValueLostPerSecond(situation, 0.0, kOptions) == Approx(9.9 / 2.5));
  CHECK(ValueLostPerSecond(Corridor({{0, 1}}), 0.0, kOptions) >
        ValueLostPerSecond(Corridor({{0, 7}}), 0.0, kOptions));
  // A period is the mean time of the moves so far.
  CHECK(DecisionPeriodSeconds(RobotState{}) == 2.5);
  CHECK(DecisionPeriodSeconds({.cell_moves = 4, .low_level_steps = 48}) == 3.0);
}

TEST_CASE("off the operator's path a robot loses log n more per period", "[planner][value]") {
  Situation situation = Corridor({{0, 2}});
  const double before = ValueLostPerSecond(situation, 0.0, kOptions);
  situation.guided_before = true;
  situation.state.path = {{0, 2}, {0, 1}, {0, 0}};
  CHECK(ValueLostPerSecond(situation, 0.0, kOptions) == Approx(before + std::log(3.0) / 2.5));
  situation.guidance = Guidance{.path = {{0, 0}, {0, 1}}};
  CHECK(ValueLostPerSecond(situation, 0.0, kOptions) == Approx(before));
}

TEST_CASE("the value of an answer is spread over the time that the robot waits for it",
          "[planner][value]") {
  const Situation situation = Corridor({{0, 2}});
  const double before = ValueLostPerSecond(situation, 30.0, kOptions);
  CHECK(before == ValueLostPerSecond(situation, 0.0, kOptions));
  ValueLostOptions options = kOptions;
  options.answer_timeout_s = 60.0;
  CHECK(ValueLostPerSecond(situation, 30.0, options) == Approx(before + 0.5));
}

TEST_CASE("the answer's value is that of the view over the best visited move", "[planner][value]") {
  const SearchAction view{CommandKind::kTransmitView, {}, 0.0, 50, 12.0, 1.0, 1.0};
  const SearchAction move{CommandKind::kMove, {0, 1}, 0.0, 20, 7.0, 0.0, 1.0};
  const SearchAction worse{CommandKind::kMove, {1, 0}, 0.0, 5, -7.0, 0.0, 1.0};
  const SearchAction unseen{CommandKind::kMove, {1, 1}, 0.0, 0, 99.0, 0.0, 1.0};
  CHECK(AnswerValue(std::vector{view, worse, move, unseen}, view) == 5.0);
  CHECK(AnswerValue(std::vector{view}, view) == 0.0);
  CHECK(AnswerValue(std::vector{move, worse}, worse) == 0.0);
}
