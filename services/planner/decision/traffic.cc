#include "planner/decision/traffic.h"

#include <algorithm>

#include "common/grid/geometry.h"

namespace conav::planner {
namespace {

using Path = std::vector<Cell>;

RightOfWay RightOf(const std::string& robot, bool has_path, bool has_goals) {
  const auto tier = has_path    ? RightOfWay::kHasPath
                    : has_goals ? RightOfWay::kHasGoals
                                : RightOfWay::kHasNone;
  return {tier, robot, 0};
}

RightOfWay RightOf(const Neighbour& other) {
  return RightOf(other.robot, !other.path.empty(), other.has_goals);
}

RightOfWay RightOf(const Situation& situation, const Path& own_path) {
  return RightOf(situation.state.robot, !own_path.empty(), !situation.state.goals_left.empty());
}

/// Cells that another robot is to have before this one.
struct Claim {
  const Neighbour* robot;
  const Path* cells;
  RightOfWay right;
};

/// All that go before `right`, the first first.
std::vector<Claim> ClaimsBefore(const Situation& situation, const RightOfWay& right) {
  std::vector<Claim> claims;
  for (const Neighbour& other : situation.neighbours) {
    if (!other.path.empty()) claims.push_back({&other, &other.path, RightOf(other)});
    if (!other.room.cells.empty()) claims.push_back({&other, &other.room.cells, other.room.right});
  }
  std::erase_if(claims, [&](const Claim& claim) {
    return !(claim.right < right) || claim.right.robot == right.robot;
  });
  std::stable_sort(claims.begin(), claims.end(),
                   [](const Claim& a, const Claim& b) { return a.right < b.right; });
  return claims;
}

/// How this robot can get out of the way of one claim.
class Room {
 public:
  Room(const Situation& situation, const Claim& asked, const std::vector<Claim>& claims)
      : situation_(situation),
        asked_(asked),
        claims_(claims),
        until_here_(asked.cells->begin(),
                    std::find(asked.cells->begin(), asked.cells->end(), situation.state.cell)) {}

  /// The asking robot is that near.
  bool is_urgent() const { return static_cast<std::ptrdiff_t>(until_here_.size()) < kLookAhead; }

  /// Beside or behind this robot; past others if there is no other.
  Path BesideOrBehind() const {
    const auto free = [&](Cell cell) {
      return !StandsOn(situation_, cell) && !Contains(until_here_, cell);
    };
    const auto not_past = [&](Cell cell) {
      return cell != asked_.robot->cell && !Contains(until_here_, cell);
    };
    Path path = Find(free, claims_);
    if (path.empty()) path = Find(not_past, claims_);
    // On the paths of those that would not go before the one that asked.
    if (asked_.right.tier != RightOfWay::kShutIn) return path;
    if (path.empty()) path = Find(free, BeforeAsked());
    if (path.empty()) path = Find(not_past, BeforeAsked());
    return path;
  }
  /// Towards the one that asked, without passing it.
  Path Before() const {
    return Find([&](Cell cell) { return !StandsOn(situation_, cell); }, claims_);
  }
  /// Ahead of the one that asked, along its path.
  Path Ahead() const {
    const auto here = std::find(asked_.cells->begin(), asked_.cells->end(), situation_.state.cell);
    return here == asked_.cells->end() ? Path{} : Path(here + 1, asked_.cells->end());
  }
  /// Past the one that asked.
  Path Past() const {
    return Find([](Cell) { return true; }, claims_);
  }

 private:
  /// The claims up to the one that asked.
  std::span<const Claim> BeforeAsked() const {
    return {claims_.data(), static_cast<std::size_t>(&asked_ - claims_.data()) + 1};
  }

  template <class Passable>
  Path Find(Passable&& passable, std::span<const Claim> kept_clear) const {
    const OccupancyGrid& map = situation_.map.cells;
    const auto known_free = [&](Cell cell) {
      return map[cell] == Occupancy::kFree && passable(cell);
    };
    const auto aside = [&](Cell cell) {
      if (cell == situation_.state.cell || StandsOn(situation_, cell)) return false;
      return std::none_of(kept_clear.begin(), kept_clear.end(),
                          [&](const Claim& claim) { return Contains(*claim.cells, cell); });
    };
    return PathToNearest(map, situation_.state.cell, known_free, aside);
  }

  const Situation& situation_;
  const Claim& asked_;
  const std::vector<Claim>& claims_;
  Path until_here_;  // of the path of the one that asked
};

/// Whether `other`, which stands on `path`, finds no cell off it once this robot is on `our_cell`.
bool WouldBeShutIn(const Situation& situation, const Neighbour& other, const Path& path,
                   Cell our_cell) {
  const OccupancyGrid& map = situation.map.cells;
  const auto passable = [&](Cell cell) {
    return cell != our_cell && map[cell] != Occupancy::kOccupied && !StandsOn(situation, cell);
  };
  const auto off = [&](Cell cell) { return cell != our_cell && !Contains(path, cell); };
  return PathToNearest(map, other.cell, passable, off).empty();
}

}  // namespace

const Neighbour* StandingOn(const Situation& situation, Cell cell) {
  const auto found = std::ranges::find_if(situation.neighbours, [&](const Neighbour& other) {
    return other.cell == cell || other.entering == cell;
  });
  return found == situation.neighbours.end() ? nullptr : &*found;
}

bool StandsOn(const Situation& situation, Cell cell) {
  return StandingOn(situation, cell) != nullptr;
}

bool IsTaken(const Situation& situation, Cell cell) {
  const auto needs = [&](const Neighbour& other) {
    const RightOfWay& right = other.room.right;
    return right.tier == RightOfWay::kShutIn && right.robot != situation.state.robot &&
           Contains(other.room.cells, cell);
  };
  return StandsOn(situation, cell) ||
         std::any_of(situation.neighbours.begin(), situation.neighbours.end(), needs);
}

std::vector<Cell> TakenCells(const Situation& situation) {
  std::vector<Cell> cells;
  for (const Neighbour& other : situation.neighbours) {
    cells.push_back(other.cell);
    if (other.entering) cells.push_back(*other.entering);
    for (const Cell cell : other.room.cells) {
      if (IsTaken(situation, cell)) cells.push_back(cell);
    }
  }
  return cells;
}

std::vector<Cell> DesiredPath(const Situation& situation) {
  const OccupancyGrid& map = situation.map.cells;
  const auto may_be_free = [&](Cell cell) { return map[cell] != Occupancy::kOccupied; };
  const auto is_goal = [&](Cell cell) { return Contains(situation.state.goals_left, cell); };
  return PathToNearest(map, situation.state.cell, may_be_free, is_goal);
}

RoomClaim MakeRoom(const Situation& situation, const std::vector<Cell>& own_path, bool insists) {
  const auto claims = ClaimsBefore(situation, RightOf(situation, own_path));
  for (const Claim& asked : claims) {
    if (!Contains(*asked.cells, situation.state.cell)) continue;
    const Room room(situation, asked, claims);
    RightOfWay handed_on = asked.right;
    ++handed_on.passed_on;
    if (Path path = room.BesideOrBehind(); !path.empty()) {
      if (room.is_urgent()) return {std::move(path), std::move(handed_on)};
      continue;  // there is time, but perhaps not for the next one
    }
    if (asked.right.tier == RightOfWay::kShutIn) {
      Path path = room.Before();
      return {path.empty() ? room.Ahead() : std::move(path), std::move(handed_on)};
    }
    Path out = room.Past();
    if (out.empty() && insists) out = own_path;
    return {std::move(out), {RightOfWay::kShutIn, situation.state.robot, 0}};
  }
  return {};
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

const Neighbour* WaitsFor(const Situation& situation, const std::vector<Cell>& path) {
  if (path.empty()) return nullptr;
  const RightOfWay ours = RightOf(situation, path);
  const auto end = path.begin() + std::min(kLookAhead, std::ssize(path));
  for (const Neighbour& other : situation.neighbours) {
    if (RightOf(other) < ours || std::find(path.begin(), end, other.cell) == end) continue;
    if (other.cell == path.front()) return &other;
    if (WouldBeShutIn(situation, other, path, path.front())) return &other;
  }
  return nullptr;
}

const Neighbour* InTheWay(const Situation& situation, const std::vector<Cell>& path) {
  if (path.empty()) return nullptr;
  const Neighbour* other = WaitsFor(situation, path);
  return other != nullptr ? other : StandingOn(situation, path.front());
}

}  // namespace conav::planner
