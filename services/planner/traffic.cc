#include "planner/traffic.h"

#include <algorithm>
#include <deque>

namespace conav::planner {
namespace {

/// Room is made for a robot that would come through within this many steps.
constexpr std::size_t kLookAhead = 4;

bool Contains(const std::vector<Cell>& cells, Cell cell) {
  return std::find(cells.begin(), cells.end(), cell) != cells.end();
}

bool GoesBefore(const Neighbour& other, const Situation& situation) {
  const bool other_has_goals = !other.way.empty();
  const bool we_have_goals = !situation.state.goals_left.empty();
  if (other_has_goals != we_have_goals) return other_has_goals;
  return other.robot < situation.state.robot;
}

/// Breadth-first from the robot's cell to the nearest cell for which `wanted` holds, over cells
/// that `passable` admits; the cells entered, empty when there is none (or the robot stands on
/// one).
template <class Passable, class Wanted>
std::vector<Cell> WayToNearest(const Situation& situation, Passable&& passable, Wanted&& wanted) {
  const OccupancyGrid& map = situation.map.cells;
  const Cell start = situation.state.cell;
  Grid<Cell> parent(map.rows(), map.columns(), Cell{-1, -1});
  parent[start] = start;
  std::deque<Cell> open{start};
  while (!open.empty()) {
    const Cell cell = open.front();
    open.pop_front();
    if (wanted(cell)) {
      std::vector<Cell> way;
      for (Cell at = cell; at != start; at = parent[at]) way.push_back(at);
      std::reverse(way.begin(), way.end());
      return way;
    }
    for (const Cell offset : kNeighbourOffsets) {
      const Cell next = cell + offset;
      if (!map.Contains(next) || parent[next].row >= 0 || !passable(next)) continue;
      parent[next] = cell;
      open.push_back(next);
    }
  }
  return {};
}

bool OnUrgentPart(const std::vector<Cell>& way, Cell cell) {
  const auto end = way.begin() + static_cast<std::ptrdiff_t>(std::min(kLookAhead, way.size()));
  return std::find(way.begin(), end, cell) != end;
}

}  // namespace

std::vector<Cell> DesiredWay(const Situation& situation) {
  const OccupancyGrid& map = situation.map.cells;
  const auto may_be_free = [&](Cell cell) { return map[cell] != Occupancy::kOccupied; };
  const auto is_goal = [&](Cell cell) { return Contains(situation.state.goals_left, cell); };
  return WayToNearest(situation, may_be_free, is_goal);
}

std::vector<Cell> Method::WayFor(const Situation& situation) const { return DesiredWay(situation); }

std::optional<Cell> StepAside(const Situation& situation) {
  std::vector<Cell> reserved;  // ways of the robots that go before
  bool in_the_way = false;
  for (const Neighbour& other : situation.neighbours) {
    if (!GoesBefore(other, situation)) continue;
    reserved.insert(reserved.end(), other.way.begin(), other.way.end());
    in_the_way = in_the_way || OnUrgentPart(other.way, situation.state.cell);
  }
  if (!in_the_way) return std::nullopt;
  const OccupancyGrid& map = situation.map.cells;
  const auto passable = [&](Cell cell) {
    const bool taken = std::any_of(situation.neighbours.begin(), situation.neighbours.end(),
                                   [&](const Neighbour& other) { return other.cell == cell; });
    return map[cell] == Occupancy::kFree && !taken;
  };
  const auto aside = [&](Cell cell) { return !Contains(reserved, cell); };
  const std::vector<Cell> way = WayToNearest(situation, passable, aside);
  if (way.empty()) return std::nullopt;
  return way.front();
}

std::optional<Cell> StepAnywhere(const Situation& situation, Random& random) {
  std::vector<Cell> free;
  for (const Cell offset : kNeighbourOffsets) {
    const Cell cell = situation.state.cell + offset;
    const bool taken = std::any_of(situation.neighbours.begin(), situation.neighbours.end(),
                                   [&](const Neighbour& other) { return other.cell == cell; });
    if (situation.map.cells.Contains(cell) && situation.map.cells[cell] == Occupancy::kFree &&
        !taken) {
      free.push_back(cell);
    }
  }
  if (free.empty()) return std::nullopt;
  return free[static_cast<std::size_t>(
      random.Uniform(0, static_cast<std::int64_t>(free.size()) - 1))];
}

const Neighbour* WaitsFor(const Situation& situation, const std::vector<Cell>& way) {
  if (way.empty()) return nullptr;
  for (const Neighbour& other : situation.neighbours) {
    if (other.cell == way.front() && !GoesBefore(other, situation)) return &other;
  }
  return nullptr;
}

}  // namespace conav::planner
