#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include "operator/simulated/path_planner.h"
#include "operator/simulated/synthetic_teleoperator.h"

namespace conav::operators {
namespace {

/// The shortest way from `start` over free cells that are not `taken`, to the first cell for which
/// `wanted` holds; empty when there is none.
template <class Wanted>
std::vector<Cell> PathOut(const Meeting& meeting, Cell start, const std::set<Cell>& taken,
                          Wanted&& wanted) {
  Grid<Cell> previous(meeting.map.rows(), meeting.map.columns(), Cell{-1, -1});
  std::queue<Cell> open({start});
  previous[start] = start;
  while (!open.empty()) {
    const Cell cell = open.front();
    open.pop();
    if (cell != start && wanted(cell)) {
      std::vector<Cell> path{cell};
      while (path.back() != start) path.push_back(previous[path.back()]);
      std::reverse(path.begin(), path.end());
      return path;
    }
    for (const Cell offset : kNeighbourOffsets) {
      const Cell next = cell + offset;
      if (!meeting.map.Contains(next) || previous[next] != Cell{-1, -1} || taken.contains(next) ||
          meeting.walls.contains(next) || IsWall(meeting.map, next)) {
        continue;
      }
      previous[next] = cell;
      open.push(next);
    }
  }
  return {};
}

}  // namespace

std::vector<DriveTask> MakeRoom(const Meeting& meeting) {
  const auto off = [](const std::vector<Cell>& path) {
    return [&path](Cell cell) { return std::find(path.begin(), path.end(), cell) == path.end(); };
  };
  std::set<Cell> taken = meeting.others;
  taken.insert(meeting.cell);
  const auto aside = PathOut(meeting, meeting.blocker_cell, taken, off(meeting.path));
  if (!aside.empty()) return {{meeting.blocker, aside.back()}};
  const auto past_us = PathOut(meeting, meeting.blocker_cell, meeting.others, off(meeting.path));
  if (past_us.empty()) return {};
  taken = meeting.others;
  taken.insert(meeting.blocker_cell);
  const auto retreat = PathOut(meeting, meeting.cell, taken, off(past_us));
  if (retreat.empty()) return {};
  return {{meeting.robot, retreat.back()}, {meeting.blocker, past_us.back()}};
}

}  // namespace conav::operators

// Whom to steer: the part of SyntheticTeleoperator that lets robots pass each other.
namespace conav::operators {
namespace {

/// After so many tasks without a goal reached people try something else.
constexpr int kManyTasks = 20;
constexpr int kKeysOfTask = 80;
/// Cells off the middle of its own within which a robot leaves the neighbours alone: 0.25 m of a
/// cell's 2 m are its body's.
constexpr double kOutOfTheWay = 0.3;

}  // namespace

std::string SyntheticTeleoperator::Choose() {
  std::size_t left = 0;
  for (const auto& [name, robot] : robots_) {
    if (robot.state) left += robot.state->goals_left.size();
  }
  if (left != std::exchange(goals_left_, left)) tasks_in_a_row_ = 0;
  while (!tasks_.empty() && Arrived(tasks_.front())) tasks_.pop_front();
  if (!tasks_.empty()) return tasks_.front().robot;
  const auto busy = robots_.find(steered_);
  if (busy != robots_.end() && !busy->second.finished()) return steered_;
  for (const auto& [name, robot] : robots_) {
    if (!robot.finished()) return name;
  }
  return "";
}

bool SyntheticTeleoperator::Arrived(const DriveTask& task) const {
  const Robot& robot = robots_.at(task.robot);
  return task.keys_left <= 0 ||
         (robot.state->cell == task.cell &&
          OffCentre(GeometryOf(robot), robot.state->position, task.cell) < kOutOfTheWay);
}

/// The robot found another one in or near a cell ahead.
void SyntheticTeleoperator::SendForRoom(const std::string& name, const Robot& robot) {
  ++counts_.meetings;
  const GridGeometry geometry = GeometryOf(robot);
  const Position place = geometry.CellToPosition(robot.state->command_cell);
  const Robot* nearest = nullptr;
  double least = 0.0;
  for (const auto& [other_name, other] : robots_) {
    if (other_name == name || other.world != robot.world || !other.state) continue;
    const double distance =
        std::hypot(other.state->position.x_m - place.x_m, other.state->position.y_m - place.y_m);
    if (nearest != nullptr && distance >= least) continue;
    nearest = &other;
    least = distance;
  }
  if (nearest == nullptr) return;
  // One that stands in two cells goes to the middle of its own; one in the middle has to be driven
  // around, or away, which is found out when the path is drawn.
  const RobotState& other = *nearest->state;
  if (OffCentre(geometry, other.position, other.cell) >= kOutOfTheWay) {
    tasks_.push_front({other.robot, other.cell, kKeysOfTask});
    ++tasks_in_a_row_;
  } else if (!tasks_.empty() && tasks_.front().robot == name) {
    tasks_.pop_front();
    SendAnywhere(robot);
  }
}

/// Breaks a circle of robots that wait for each other.
void SyntheticTeleoperator::SendAnywhere(const Robot& robot) {
  std::vector<std::string> names;
  for (const auto& [name, other] : robots_) {
    if (other.world == robot.world && other.state) names.push_back(name);
  }
  const std::string& name = names[static_cast<std::size_t>(
      random_.Uniform(0, static_cast<std::int64_t>(names.size()) - 1))];
  const Cell from = robots_.at(name).state->cell;
  const StreamMemory& seen = *worlds_.at(robot.world).seen;
  std::vector<Cell> near;
  for (int row = from.row - 3; row <= from.row + 3; ++row) {
    for (int column = from.column - 3; column <= from.column + 3; ++column) {
      const Cell cell{row, column};
      const bool inside = worlds_.at(robot.world).belief->wall_probability.Contains(cell);
      if (cell != from && inside && seen.IsFree(cell)) near.push_back(cell);
    }
  }
  ++tasks_in_a_row_;
  if (near.empty()) return;
  const auto last = static_cast<std::int64_t>(near.size()) - 1;
  tasks_.push_front(
      {name, near[static_cast<std::size_t>(random_.Uniform(0, last))], kKeysOfTask / 2});
}

bool SyntheticTeleoperator::AskForRoom(const std::string& name, const Robot& robot,
                                       const std::vector<Cell>& path, Cell blocked) {
  const bool task = !tasks_.empty() && tasks_.front().robot == name;
  ++counts_.meetings;
  if (task || tasks_in_a_row_ >= kManyTasks) {
    if (task) tasks_.pop_front();
    if (tasks_in_a_row_ >= kManyTasks) tasks_in_a_row_ = 0;
    SendAnywhere(robot);
    return true;
  }
  const auto blocker = std::find_if(robots_.begin(), robots_.end(), [&](const auto& entry) {
    return entry.first != name && entry.second.world == robot.world && entry.second.state &&
           entry.second.state->cell == blocked;
  });
  const World& world = worlds_.at(robot.world);
  const BeliefGrid map = world.seen->Over(world.belief->wall_probability);
  const std::set<Cell> walls = world.seen->Walls();
  std::set<Cell> rest = CellsOfOthers(name, robot.world);
  rest.erase(blocked);
  ++tasks_in_a_row_;
  const std::vector<DriveTask> tasks =
      MakeRoom({map, walls, name, path.front(), path, blocker->first, blocked, rest});
  tasks_.insert(tasks_.begin(), tasks.begin(), tasks.end());
  return !tasks.empty();
}

}  // namespace conav::operators
