#include "common/msg/robot.h"

#include <cmath>
#include <utility>

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

bool Reaches(const RobotState& state, Position goal, double tolerance_m) {
  const bool is_near =
      std::hypot(state.position.x_m - goal.x_m, state.position.y_m - goal.y_m) <= tolerance_m;
  return is_near || state.grid.PositionToCell(goal) == state.cell;
}

void GoalsJoin::NoteReached() {
  if (!goals_ || !state_ || keeps_goals()) return;
  for (const Position goal : goals_->left) {
    if (std::ranges::find(reached_, goal, &Reached::goal) != reached_.end()) continue;
    if (Reaches(*state_, goal, goals_->tolerance_m)) reached_.push_back({goal, state_->stamp});
  }
}

std::optional<RobotState> GoalsJoin::Receive(RobotState state) {
  if (state_ && state.stamp < state_->stamp) reached_.clear();  // a new run
  state_ = std::move(state);
  NoteReached();
  return Joined();
}

std::optional<RobotState> GoalsJoin::Receive(RobotGoals goals) {
  goals_ = std::move(goals);
  std::erase_if(reached_, [&](const Reached& one) { return one.stamp <= goals_->stamp; });
  if (state_ && goals_->stamp < state_->stamp) NoteReached();
  return state_ ? Joined() : std::nullopt;
}

std::optional<RobotState> GoalsJoin::Joined() const {
  if (keeps_goals() && (!goals_ || goals_->stamp != state_->goals_stamp)) return std::nullopt;
  RobotState state = *state_;
  if (!goals_) return state;
  std::vector<Position> left = goals_->left;
  std::vector<Position> reached = goals_->reached;
  for (const Reached& one : reached_) {
    if (std::erase(left, one.goal) > 0) reached.push_back(one.goal);
  }
  state.goals_left = CellsOf(state.grid, left);
  state.goals_reached = CellsOf(state.grid, reached);
  state.goals_total = goals_->total;
  return state;
}

}  // namespace conav
