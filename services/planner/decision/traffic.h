#pragma once

#include <algorithm>
#include <chrono>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "common/grid/grid.h"
#include "common/runtime/clock.h"
#include "common/runtime/random.h"
#include "planner/decision/method.h"

namespace conav::planner {

/// Room is made for a robot that would come through within this many steps.
inline constexpr std::ptrdiff_t kLookAhead = 4;

/// Whether no robot can ever be in `cell`, by a robot's own map.
inline bool IsKnownWall(const OccupancyGrid& map, Cell cell) {
  return !map.Contains(cell) || map[cell] == Occupancy::kOccupied;
}

/// Whether a path cannot be gone, by a robot's own map.
inline bool IsKnownBlocked(const OccupancyGrid& map, std::span<const Cell> path) {
  return std::any_of(path.begin(), path.end(), [&](Cell cell) { return IsKnownWall(map, cell); });
}

/// Breadth-first from `start` to the nearest cell for which `wanted` holds, over cells that
/// `passable` admits; the cells entered, empty when there is none (or it is `start`).
template <class Passable, class Wanted>
std::vector<Cell> PathToNearest(const OccupancyGrid& map, Cell start, Passable&& passable,
                                Wanted&& wanted) {
  Grid<Cell> parent(map.rows(), map.columns(), Cell{-1, -1});
  parent[start] = start;
  std::deque<Cell> open{start};
  while (!open.empty()) {
    const Cell cell = open.front();
    open.pop_front();
    if (wanted(cell)) {
      std::vector<Cell> path;
      for (Cell at = cell; at != start; at = parent[at]) path.push_back(at);
      std::reverse(path.begin(), path.end());
      return path;
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

/// Several robots in corridors one cell wide; each is decided for alone, perhaps in several
/// processes. They exchange their intended paths and the cells by which they make room
/// (IntendedPath).
///
/// The right of way (RightOfWay): a robot with an intended path goes before one that waits, and that
/// before one without goals; then names in order. A robot on the path of a robot with the right of
/// way makes room next to or behind itself, and asks robots that stand there to make room in turn,
/// handing on the right that it was asked with. If there is no room (a dead end), it is shut in: now
/// it goes before all others on a path past the robot that it has to let pass, and that robot backs
/// off until it can, also onto the paths of robots that wait. A robot that knows of no such
/// path insists after a while: it goes before all others on its own path, into unknown cells. A
/// robot with the right of way waits a moment for others to make room, then looks for another path.
/// Robots that keep making room for each other fall out of step by random waits (YieldBackoff).
///
/// The idea of handing priority on is that of PIBT (Okumura, Machida, Defago, Tamura: "Priority
/// Inheritance with Backtracking for Iterative Multi-agent Path Finding", IJCAI 2019); letting the
/// one out that cannot get aside is added here, because mazes have dead ends.

/// Wall time for which a robot waits for another one to make room, before it tries something else.
inline constexpr std::chrono::milliseconds kPatience{500};

/// How long a robot has been waiting for others to make room. Time in which the one in its way drives
/// does not count: it may be slow.
class Patience {
 public:
  /// `clock` outlives this.
  explicit Patience(const Clock& clock) : clock_(clock) {}

  /// The robot waits for `other`, or, if that is null, for a cell that is needed by one that is shut
  /// in: whether it goes on waiting.
  bool Holds(const Neighbour* other) {
    const Clock::TimePoint now = clock_.Now();
    const bool drives = other != nullptr && other->is_driving;
    if (!waits_ || drives || drove_) since_ = now;
    waits_ = true;
    drove_ = drives;
    return now - since_ < kPatience;
  }
  /// The decision to wait until it ends, or something changes.
  Decision Wait() const {
    Decision wait;
    if (waits_ && !drove_) wait.again = since_ + kPatience;
    return wait;
  }
  void End() { waits_ = drove_ = false; }

 private:
  const Clock& clock_;
  Clock::TimePoint since_{};
  bool waits_ = false;
  bool drove_ = false;  // the other one, when last asked about
};

/// The robot that stands on `cell` or drives into it; null if none.
const Neighbour* StandingOn(const Situation& situation, Cell cell);
/// Whether another robot stands on `cell` or drives into it.
bool StandsOn(const Situation& situation, Cell cell);
/// The same, or another robot that is shut in needs it: not to be entered.
bool IsTaken(const Situation& situation, Cell cell);
/// All such cells.
std::vector<Cell> TakenCells(const Situation& situation);

/// Cells that the robot would enter next if no other robot were there: the shortest path to its
/// nearest goal over cells that are not known to be walls; empty without goals. The other robots
/// receive it and make room.
std::vector<Cell> DesiredPath(const Situation& situation);

/// The known free cells by which this robot makes room, up to the nearest one that is on no path of
/// a robot with the right of way. Empty when it is within the next few cells of no such path, and
/// when there is no room. `own_path`: its intended path. `insists`: shut in for long, with no known
/// exit.
RoomClaim MakeRoom(const Situation& situation, const std::vector<Cell>& own_path,
                   bool insists = false);

/// A free neighbour cell drawn at random: the last resort of robots that wait for each other.
std::optional<Cell> StepAnywhere(const Situation& situation, Random& random);

/// The neighbour to wait for before this robot enters the first cell of `path`: one that has to make
/// room and stands there, or stands on the next few cells and would be shut in. Null if none.
const Neighbour* WaitsFor(const Situation& situation, const std::vector<Cell>& path);
/// That one, or the robot on the first cell of `path`.
const Neighbour* InTheWay(const Situation& situation, const std::vector<Cell>& path);

}  // namespace conav::planner
