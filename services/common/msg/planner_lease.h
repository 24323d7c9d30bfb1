#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <vector>

#include "common/grid/grid.h"

/// Messages between planner processes that share robots; see idl/conav_msgs.
namespace conav {

/// The lease that one planner process publishes about itself.
struct PlannerLease {
  struct Held {
    std::string robot;
    std::uint64_t lease_epoch = 0;
    bool operator==(const Held&) const = default;
  };
  std::string node;
  std::string instance;             // unique per process
  std::vector<std::string> robots;  // configured for
  std::vector<Held> holds;          // driven now
  double load = 0.0;                // cores used by recent decisions
  bool leaving = false;             // the process is ending and holds nothing
  bool operator==(const PlannerLease&) const = default;
};

/// Right of way: the smaller rank goes first. In order: a robot that is shut in, one that intends a
/// path, one that has goals but no intended path (it waits), one without goals; ties go by name. A
/// robot that makes room for another inherits its rank, one step below.
struct RightOfWay {
  enum Tier : std::uint8_t { kShutIn, kHasPath, kHasGoals, kHasNone };
  Tier tier = kHasNone;
  std::string robot;
  std::uint32_t passed_on = 0;
  auto operator<=>(const RightOfWay&) const = default;
};

/// Cells through which a robot makes room for another one, nearest first; empty if it need not.
struct RoomClaim {
  std::vector<Cell> cells;
  RightOfWay right;
  bool operator==(const RoomClaim&) const = default;
};

/// The path that a robot intends to take, and its right of way.
struct IntendedPath {
  std::string robot;
  std::vector<Cell> cells;  // cells that it intends to enter next, nearest first
  RoomClaim room;
  bool operator==(const IntendedPath&) const = default;
};

}  // namespace conav
