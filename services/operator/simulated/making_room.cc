#include "operator/simulated/making_room.h"

#include <algorithm>
#include <queue>

#include "operator/simulated/path_planner.h"

namespace conav::operators {
namespace {

/// The shortest way from `start` over free cells that are not `taken`, to the first cell for which
/// `wanted` holds; empty when there is none.
template <class Wanted>
std::vector<Cell> WayOut(const Meeting& meeting, Cell start, const std::set<Cell>& taken,
                         Wanted&& wanted) {
  Grid<Cell> previous(meeting.map.rows(), meeting.map.columns(), Cell{-1, -1});
  std::queue<Cell> open({start});
  previous[start] = start;
  while (!open.empty()) {
    const Cell cell = open.front();
    open.pop();
    if (cell != start && wanted(cell)) {
      std::vector<Cell> way{cell};
      while (way.back() != start) way.push_back(previous[way.back()]);
      std::reverse(way.begin(), way.end());
      return way;
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

std::vector<Errand> MakeRoom(const Meeting& meeting) {
  const auto off = [](const std::vector<Cell>& path) {
    return [&path](Cell cell) { return std::find(path.begin(), path.end(), cell) == path.end(); };
  };
  std::set<Cell> taken = meeting.others;
  taken.insert(meeting.cell);
  const auto aside = WayOut(meeting, meeting.blocker_cell, taken, off(meeting.path));
  if (!aside.empty()) return {{meeting.blocker, aside.back()}};
  const auto past_us = WayOut(meeting, meeting.blocker_cell, meeting.others, off(meeting.path));
  if (past_us.empty()) return {};
  taken = meeting.others;
  taken.insert(meeting.blocker_cell);
  const auto retreat = WayOut(meeting, meeting.cell, taken, off(past_us));
  if (retreat.empty()) return {};
  return {{meeting.robot, retreat.back()}, {meeting.blocker, past_us.back()}};
}

}  // namespace conav::operators
