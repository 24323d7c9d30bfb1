#include "planner/decision/method.h"

#include <algorithm>
#include <cmath>

#include "planner/decision/traffic.h"

namespace conav::planner {

Decision MoveAlong(std::vector<Cell> plan) {
  Decision decision;
  decision.action = Action{CommandKind::kMove, plan.front(), 0.0};
  decision.report.actions.push_back({.target = plan.front(), .visits = 1});
  decision.report.chosen = 0;
  decision.plan = std::move(plan);
  return decision;
}

namespace {

constexpr double kLowLevelStepS = 0.25;
constexpr double kUsualPeriodS = 2.5;

bool IsOnGuidance(const Situation& situation) {
  if (!situation.guidance) return false;
  const std::vector<Cell>& path = situation.guidance->path;
  return std::find(path.begin(), path.end(), situation.state.cell) != path.end();
}

}  // namespace

double DecisionPeriodSeconds(const RobotState& state) {
  if (state.cell_moves == 0 || state.low_level_steps == 0) return kUsualPeriodS;
  return kLowLevelStepS * static_cast<double>(state.low_level_steps) /
         static_cast<double>(state.cell_moves);
}

double TourReturn(const Situation& situation, const ValueLostOptions& options) {
  const OccupancyGrid& map = situation.map.cells;
  std::vector<Cell> goals = situation.state.goals_left;
  const auto passable = [&](Cell cell) { return map[cell] != Occupancy::kOccupied; };
  const auto is_goal = [&](Cell cell) {
    return std::find(goals.begin(), goals.end(), cell) != goals.end();
  };
  double tour_return = 0.0;
  double weight = 1.0;  // gamma^k
  Cell at = situation.state.cell;
  while (!goals.empty()) {
    std::erase(goals, at);
    const std::vector<Cell> way = PathToNearest(map, at, passable, is_goal);
    if (way.empty()) break;
    for (const Cell cell : way) {
      tour_return += weight * EnvironmentReward(cell == way.back(), options.reward);
      weight *= options.discount;
    }
    at = way.back();
  }
  return tour_return;
}

double AnswerValue(std::span<const SearchAction> actions, const SearchAction& chosen) {
  std::optional<double> best_move;
  for (const SearchAction& action : actions) {
    if (action.kind != CommandKind::kMove || action.visits == 0) continue;
    best_move = std::max(best_move.value_or(action.mean_value), action.mean_value);
  }
  return best_move ? std::max(0.0, chosen.mean_value - *best_move) : 0.0;
}

double ValueLostPerSecond(const Situation& situation, double answer_value,
                          const ValueLostOptions& options) {
  const double standing = std::max(
      0.0, (1.0 - options.discount) * TourReturn(situation, options) - options.reward.step);
  const int path_length = std::max(1, static_cast<int>(situation.state.path.size()));
  const double staleness =
      -GuidanceReward(situation.guided_before, IsOnGuidance(situation), path_length);
  const double answer =
      options.answer_timeout_s > 0.0 ? answer_value / options.answer_timeout_s : 0.0;
  return (standing + staleness) / DecisionPeriodSeconds(situation.state) + answer;
}

}  // namespace conav::planner
