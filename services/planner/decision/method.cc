#include "planner/decision/method.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "common/grid/geometry.h"
#include "planner/decision/traffic.h"
#include "planner/navigation/cell_line.h"

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

constexpr std::chrono::minutes kValidFor{10};

bool Passable(const MapUpdate& map, const Belief& belief, Cell cell) {
  if (map.cells[cell] == Occupancy::kUnknown) return belief.wall_probability[cell] < 0.5F;
  return map.cells[cell] == Occupancy::kFree;
}

/// With `from` as its first cell; empty when there is no path.
std::vector<Cell> ShortestPath(const MapUpdate& map, const Belief& belief, Cell from, Cell to) {
  if (from == to) return {from};
  std::vector<Cell> path = PathToNearest(
      map.cells, from, [&](Cell cell) { return Passable(map, belief, cell); },
      [&](Cell cell) { return cell == to; });
  if (!path.empty()) path.insert(path.begin(), from);
  return path;
}

}  // namespace

namespace {

/// The cells of lines that connect the robot's cell and the places; neighbours share a side.
std::vector<Cell> CellsAlong(Cell from, const std::vector<Cell>& places) {
  std::vector<Cell> path{from};
  for (const Cell place : places) {
    WalkLine(path.back(), place, [&](Cell cell) {
      const Cell step = cell - path.back();
      // Of the two cells at a corner one is enough.
      if (std::abs(step.row) + std::abs(step.column) == 1) path.push_back(cell);
      return true;
    });
  }
  return path;
}

}  // namespace

Result<Guidance> GuidanceAlong(const std::vector<Position>& places, const RobotState& state,
                               const MapUpdate& map, const Belief& belief,
                               const std::optional<Guidance>& current) {
  std::vector<Cell> cells;
  for (const Position& place : places) {
    const Cell cell = map.geometry().PositionToCell(place);
    if (!map.cells.Contains(cell)) {
      return Fail(ErrorCode::kOutOfRange,
                  fmt::format("({:.2f}, {:.2f}) m lies in cell {}, outside of the {}x{} map",
                              place.x_m, place.y_m, cell, map.cells.rows(), map.cells.columns()));
    }
    cells.push_back(cell);
  }
  Guidance guidance = current.value_or(Guidance{});
  guidance.path = cells.size() == 1 ? ShortestPath(map, belief, state.cell, cells.front())
                                    : CellsAlong(state.cell, cells);
  if (cells.empty() || guidance.path.empty()) {
    return Fail(ErrorCode::kNotFound, cells.empty() ? "the path is empty"
                                                    : fmt::format("no path from {} to cell {}",
                                                                  state.cell, cells.back()));
  }
  guidance.stamp = state.stamp;
  guidance.world = state.world;
  guidance.robot = state.robot;
  guidance.given_by = "goal_pose";
  guidance.belief_revision = std::min(guidance.belief_revision, belief.revision);
  guidance.answers_snapshot = state.snapshots;
  guidance.valid_until = state.stamp + kValidFor;
  return guidance;
}

namespace {

/// The robot has seen the end of the operator's path, and there is no goal left.
bool IsUsedUp(const Situation& situation) {
  if (!situation.guidance || situation.guidance->path.empty()) return false;
  const Cell end = situation.guidance->path.back();
  return situation.map.cells[end] != Occupancy::kUnknown &&
         !Contains(situation.state.goals_left, end);
}

/// Empty when the robot knows of none.
std::vector<Cell> KnownGoals(const Situation& situation, GoalKnowledge knowledge) {
  const RobotState& state = situation.state;
  const OccupancyGrid& map = situation.map.cells;
  std::vector<Cell> goals = state.goals_left;
  const std::vector<Cell> path =
      situation.guidance ? situation.guidance->path : std::vector<Cell>{};
  if (knowledge == GoalKnowledge::kSeen) {
    std::erase_if(goals, [&](Cell goal) {
      return map[goal] == Occupancy::kUnknown && !Contains(path, goal);
    });
  }
  if (!goals.empty()) return goals;
  if (!path.empty() && path.back() != state.cell && map[path.back()] == Occupancy::kUnknown &&
      !IsKnownBlocked(map, path)) {
    return {path.back()};
  }
  return {};
}

/// The nearest cell that the robot has not seen; empty when it has seen all that it can reach.
std::vector<Cell> NearestUnseen(const Situation& situation) {
  const OccupancyGrid& map = situation.map.cells;
  const auto way = PathToNearest(
      map, situation.state.cell, [&](Cell cell) { return map[cell] != Occupancy::kOccupied; },
      [&](Cell cell) { return map[cell] == Occupancy::kUnknown && !map.OnBorder(cell); });
  if (way.empty()) return {};
  return {way.back()};
}

}  // namespace

void LimitKnowledge(Situation& situation, GoalKnowledge knowledge) {
  if (knowledge == GoalKnowledge::kAll) return;
  if (IsUsedUp(situation)) {  // as if there never had been one
    situation.guidance.reset();
    situation.guided_before = false;
  }
  RobotState& state = situation.state;
  const std::size_t found = state.goals_left.size() + state.goals_reached.size();
  if (knowledge == GoalKnowledge::kTold && found < state.goals_total) {
    situation.goals_to_find = state.goals_total - static_cast<std::uint32_t>(found);
  }
  const bool has_goals = state.goals_reached.size() < state.goals_total;
  std::vector<Cell> goals = has_goals ? KnownGoals(situation, knowledge) : std::vector<Cell>{};
  if (goals.empty() && has_goals) {
    situation.lacks_way = knowledge == GoalKnowledge::kSeen;
    goals = NearestUnseen(situation);
  }
  state.goals_left = std::move(goals);
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
    const std::vector<Cell> path = PathToNearest(map, at, passable, is_goal);
    if (path.empty()) break;
    for (const Cell cell : path) {
      tour_return += weight * EnvironmentReward(cell == path.back(), options.reward);
      weight *= options.discount;
    }
    at = path.back();
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
  const double staleness = -GuidanceReward(
      GuidanceWeight(situation.guided_before, IsOnGuidance(situation)), path_length);
  const double answer =
      options.answer_timeout_s > 0.0 ? answer_value / options.answer_timeout_s : 0.0;
  return (standing + staleness) / DecisionPeriodSeconds(situation.state) + answer;
}

}  // namespace conav::planner
