#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/grid/grid.h"

namespace conav::operators {

/// A robot to be driven somewhere for the sake of another one.
struct DriveTask {
  std::string robot;
  Cell cell;
  int keys_left = 80;  // then it is given up
  bool operator==(const DriveTask&) const = default;
};

/// Where robots stand, for the question who makes room.
struct Meeting {
  const BeliefGrid& map;        // with what was seen
  const std::set<Cell>& walls;  // known for certain
  std::string robot;            // that has to pass
  Cell cell;
  std::vector<Cell> path;  // that it wants, from its cell on
  std::string blocker;     // stands on the path
  Cell blocker_cell;
  std::set<Cell> others;  // cells of all other robots
};

/// What to drive where so that `robot` can pass `blocker`, in order: the blocker off the path; or,
/// where `robot` shuts it in, first `robot` off the blocker's way out. Empty when neither is
/// possible on cells that the map shows free.
std::vector<DriveTask> MakeRoom(const Meeting& meeting);

}  // namespace conav::operators
