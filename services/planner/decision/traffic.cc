#include "planner/decision/traffic.h"

#include <algorithm>

#include "planner/decision/way_to_nearest.h"

namespace conav::planner {
namespace {

/// Room is made for a robot that would come through within this many steps.
constexpr std::size_t kLookAhead = 4;

bool Contains(const std::vector<Cell>& cells, Cell cell) {
  return std::find(cells.begin(), cells.end(), cell) != cells.end();
}

bool GoesBefore(const Neighbour& other, const Situation& situation) {
  const bool we_have_goals = !situation.state.goals_left.empty();
  if (other.has_goals != we_have_goals) return other.has_goals;
  return other.robot < situation.state.robot;
}

bool OnUrgentPart(const std::vector<Cell>& way, Cell cell) {
  const auto end = way.begin() + static_cast<std::ptrdiff_t>(std::min(kLookAhead, way.size()));
  return std::find(way.begin(), end, cell) != end;
}

/// Where `other`, which stands on `way`, can get off it while this robot stands on `our_cell`:
/// through that cell if `past_us`, and not onto it. Empty when nowhere.
std::vector<Cell> WayOff(const Situation& situation, const Neighbour& other,
                         const std::vector<Cell>& way, Cell our_cell, bool past_us) {
  const OccupancyGrid& map = situation.map.cells;
  const auto passable = [&](Cell cell) {
    if (cell == our_cell) return past_us;
    return map[cell] != Occupancy::kOccupied && !IsTaken(situation, cell);
  };
  const auto off = [&](Cell cell) { return cell != our_cell && !Contains(way, cell); };
  return WayToNearest(map, other.cell, passable, off);
}

/// Out of the way of a robot that has to make room but cannot, because this one shuts it in.
std::optional<Cell> BackOff(const Situation& situation, const std::vector<Cell>& own_way) {
  if (own_way.empty()) return std::nullopt;
  const OccupancyGrid& map = situation.map.cells;
  const Cell here = situation.state.cell;
  for (const Neighbour& other : situation.neighbours) {
    if (other.cell != own_way.front() || GoesBefore(other, situation)) continue;
    if (!WayOff(situation, other, own_way, here, false).empty()) continue;
    const std::vector<Cell> escape = WayOff(situation, other, own_way, here, true);
    if (escape.empty()) continue;
    const auto passable = [&](Cell cell) {
      return map[cell] == Occupancy::kFree && !IsTaken(situation, cell);
    };
    const auto off = [&](Cell cell) { return cell != here && !Contains(escape, cell); };
    const std::vector<Cell> retreat = WayToNearest(map, here, passable, off);
    if (!retreat.empty()) return retreat.front();
  }
  return std::nullopt;
}

}  // namespace

bool IsTaken(const Situation& situation, Cell cell) {
  return std::any_of(situation.neighbours.begin(), situation.neighbours.end(),
                     [&](const Neighbour& other) { return other.cell == cell; });
}

std::vector<Cell> DesiredWay(const Situation& situation) {
  const OccupancyGrid& map = situation.map.cells;
  const auto may_be_free = [&](Cell cell) { return map[cell] != Occupancy::kOccupied; };
  const auto is_goal = [&](Cell cell) { return Contains(situation.state.goals_left, cell); };
  return WayToNearest(map, situation.state.cell, may_be_free, is_goal);
}

std::optional<Cell> StepAside(const Situation& situation, const std::vector<Cell>& own_way) {
  std::vector<Cell> reserved;  // ways of the robots that go before
  bool in_the_way = false;
  for (const Neighbour& other : situation.neighbours) {
    if (!GoesBefore(other, situation)) continue;
    reserved.insert(reserved.end(), other.way.begin(), other.way.end());
    in_the_way = in_the_way || OnUrgentPart(other.way, situation.state.cell);
  }
  if (!in_the_way) return BackOff(situation, own_way);
  const OccupancyGrid& map = situation.map.cells;
  const auto known_free = [&](Cell cell) { return map[cell] == Occupancy::kFree; };
  const auto free_now = [&](Cell cell) { return known_free(cell) && !IsTaken(situation, cell); };
  const auto aside = [&](Cell cell) { return !Contains(reserved, cell); };
  std::vector<Cell> way = WayToNearest(map, situation.state.cell, free_now, aside);
  // Shut in: after the robot that backs off.
  if (way.empty()) way = WayToNearest(map, situation.state.cell, known_free, aside);
  if (way.empty() || IsTaken(situation, way.front())) return std::nullopt;
  return way.front();
}

std::optional<Cell> StepAnywhere(const Situation& situation, Random& random) {
  std::vector<Cell> free;
  for (const Cell offset : kNeighbourOffsets) {
    const Cell cell = situation.state.cell + offset;
    if (situation.map.cells.Contains(cell) && situation.map.cells[cell] == Occupancy::kFree &&
        !IsTaken(situation, cell)) {
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
    if (GoesBefore(other, situation) || !OnUrgentPart(way, other.cell)) continue;
    if (other.cell == way.front()) return &other;
    if (WayOff(situation, other, way, way.front(), false).empty()) return &other;
  }
  return nullptr;
}

}  // namespace conav::planner
