#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <vector>

#include "common/grid/grid.h"

/// What planner processes that share robots tell each other; see idl/conav_planning.idl.
namespace conav {

/// What one planner process says of itself.
struct PlannerLease {
  struct Held {
    std::string robot;
    std::uint64_t lease_epoch = 0;
    bool operator==(const Held&) const = default;
  };
  std::string node;
  std::string instance;             // unique per process
  std::vector<std::string> robots;  // that it is configured for
  std::vector<Held> holds;          // that it drives now
  double load = 0.0;                // cores that its decisions took lately
  bool leaving = false;             // it ends and holds nothing any more
  bool operator==(const PlannerLease&) const = default;
};

/// Who goes before whom: the smaller rank. A robot that is shut in, one that wants a way, one that
/// has goals but wants nothing now (it waits), one without goals; then by name. A robot that makes
/// room for another hands its rank on, one step below.
struct RightOfWay {
  enum Tier : std::uint8_t { kShutIn, kWantsAWay, kHasGoals, kHasNone };
  Tier tier = kHasNone;
  std::string robot;
  std::uint32_t passed_on = 0;
  auto operator<=>(const RightOfWay&) const = default;
};

/// Cells by which a robot makes room for another one, nearest first; empty when it need not.
struct RoomClaim {
  std::vector<Cell> way;
  RightOfWay right;
  bool operator==(const RoomClaim&) const = default;
};

/// What a robot wants of the others.
struct IntendedPath {
  std::string robot;
  std::vector<Cell> way;  // cells that it wants to enter next, nearest first
  RoomClaim room;
  bool operator==(const IntendedPath&) const = default;
};

}  // namespace conav
