#include "common/msg/robot.h"

namespace conav {
namespace {

std::vector<Cell> CellsOf(const GridGeometry& grid, const std::vector<Position>& places) {
  std::vector<Cell> cells;
  cells.reserve(places.size());
  for (const Position place : places) cells.push_back(grid.PositionToCell(place));
  return cells;
}

std::vector<Position> PlacesOf(const GridGeometry& grid, const std::vector<Cell>& cells) {
  std::vector<Position> places;
  places.reserve(cells.size());
  for (const Cell cell : cells) places.push_back(grid.CellToPosition(cell));
  return places;
}

}  // namespace

RobotGoals GoalsOf(const RobotState& state, double tolerance_m) {
  return {.stamp = state.goals_stamp,
          .world = state.world,
          .robot = state.robot,
          .left = PlacesOf(state.grid, state.goals_left),
          .reached = PlacesOf(state.grid, state.goals_reached),
          .total = state.goals_total,
          .tolerance_m = tolerance_m};
}

std::optional<RobotState> GoalsJoin::Receive(RobotState state) {
  state_ = std::move(state);
  return Joined();
}

std::optional<RobotState> GoalsJoin::Receive(RobotGoals goals) {
  goals_ = std::move(goals);
  return Joined();
}

std::optional<RobotState> GoalsJoin::Joined() const {
  if (!state_) return std::nullopt;
  const bool keeps_goals = state_->goals_stamp != SimTime{};
  if (keeps_goals && (!goals_ || goals_->stamp != state_->goals_stamp)) return std::nullopt;
  RobotState state = *state_;
  if (!goals_) return state;
  state.goals_left = CellsOf(state.grid, goals_->left);
  state.goals_reached = CellsOf(state.grid, goals_->reached);
  state.goals_total = goals_->total;
  return state;
}

}  // namespace conav
