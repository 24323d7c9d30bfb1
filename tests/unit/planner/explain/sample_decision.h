#pragma once

#include <numbers>

#include "planner/explain/decision_file.h"

namespace conav::planner {

/// A robot in the middle of a 5 x 5 world with walls around, the goal east of it, the operator's map
/// with one wall too many, at (1,1), and one missing, at (0,2). It moves east; the runner-up is to
/// the west, and a picture to the north was considered. No field is at its default.
inline DecisionRecord SampleDecision() {
  constexpr double kNorth = std::numbers::pi / 2.0;
  DecisionRecord decision;
  decision.map = OccupancyGrid(5, 5, Occupancy::kFree);
  decision.belief = BeliefGrid(5, 5, 0.0F);
  for (std::size_t i = 0; i < decision.map.size(); ++i) {
    if (!decision.map.OnBorder(decision.map.CellAt(i))) continue;
    decision.map.values()[i] = Occupancy::kOccupied;
    decision.belief.values()[i] = 1.0F;
  }
  decision.map[{3, 3}] = Occupancy::kUnknown;
  decision.belief[{1, 1}] = 0.75F;
  decision.belief[{0, 2}] = 0.25F;
  decision.goals_left = {{2, 3}};
  decision.path = {{3, 2}, {2, 2}};
  decision.guidance = {{2, 2}, {2, 3}, {1, 3}};
  decision.plan = {{2, 3}};
  decision.taken = {.kind = CommandKind::kMove, .target = {2, 3}};
  SearchReport& report = decision.report;
  report.stamp = {2'500'000'000};
  report.world = "w1";
  report.robot = "r1";
  report.method = "ig-mcts";
  report.decision = 12;
  report.cell = {2, 2};
  report.belief_revision = 3;
  report.guidance_revision = 2;
  const RewardTerms west{97.0, -1.5, -2.0, -1.0, -1.5, 3.0, -3.5};
  const RewardTerms east{.goals = 100.0, .progress = 1.0};
  const RewardTerms north{.information = 2.75, .communication = -12.0};
  using enum CommandKind;
  report.actions = {{kMove, {2, 1}, 0.0, 30, 90.5, 0.0, 0.5, west},
                    {kMove, {2, 3}, 0.0, 60, 101.0, 0.0, 1.0, east},
                    {kTransmitView, {2, 2}, kNorth, 10, -9.25, 2.75, 1.0, north},
                    {kTransmitView, {2, 2}, 2.0 * kNorth, 0, 0.0, 0.0625, 1.0, {}}};
  report.chosen = 1;
  report.has_terms = true;
  report.tree = {{-1, CommandKind::kMove, {2, 2}, 0.0, 100, 80.0, 1.0},
                 {0, CommandKind::kMove, {2, 3}, 0.0, 60, 101.0, 1.0},
                 {0, CommandKind::kMove, {2, 1}, 0.0, 30, 90.5, 0.5},
                 {2, CommandKind::kTransmitView, {2, 1}, kNorth, 12, -8.0, 1.0},
                 {0, CommandKind::kTransmitView, {2, 2}, kNorth, 10, -9.25, 1.0}};
  report.views = {{{2, 1}, kNorth, 3.5}, {{2, 2}, kNorth, 2.75}, {{2, 2}, 2.0 * kNorth, 0.0625}};
  report.iterations = 100;
  report.nodes = 70;
  report.perception_queries = 9;
  report.perception_cached = 14;
  report.perception_model = "nhpm";
  report.duration_ms = 1.25;
  return decision;
}

/// The same robot sends the picture to the north, as decision `number`.
inline DecisionRecord SampleSnapshot(std::uint64_t number) {
  DecisionRecord decision = SampleDecision();
  SearchReport& report = decision.report;
  report.decision = number;
  report.actions[1].visits = 10;
  report.actions[2].visits = 60;
  report.actions[2].mean_value = 108.0;
  report.actions[2].information_gain = 120.0;
  report.actions[2].terms = {0.0, 0.0, 0.0, 0.0, 0.0, 120.0, -12.0};
  report.chosen = 2;
  decision.taken = {.kind = CommandKind::kTransmitView,
                    .target = {2, 2},
                    .heading_rad = report.actions[2].heading_rad};
  decision.plan.clear();
  return decision;
}

/// An order of the client that steers the robot, passed on before the operator's map came.
inline DecisionRecord SampleLowLevelAction() {
  DecisionRecord decision = SampleDecision();
  decision.belief = {};
  decision.guidance.clear();
  decision.plan.clear();
  decision.taken = {.kind = CommandKind::kDrive, .target = {2, 2}};
  decision.report = {.stamp = decision.report.stamp,
                     .world = "w1",
                     .robot = "r1",
                     .method = "teleop",
                     .decision = 12,
                     .cell = {2, 2}};
  return decision;
}

/// As a method without a search decides.
inline DecisionRecord SampleWithoutSearch() {
  DecisionRecord decision = SampleDecision();
  SearchReport& report = decision.report;
  report.method = "instruction";
  report.actions = {{.target = {2, 3}, .visits = 1}};
  report.chosen = 0;
  report.has_terms = false;
  report.tree.clear();
  report.views.clear();
  report.iterations = report.nodes = 0;
  return decision;
}

}  // namespace conav::planner
