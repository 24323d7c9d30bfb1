#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "common/protocol/planner_lease.h"

namespace conav::launcher {

/// Who drives which robots, in lines for the person who watches a demo with several planners:
/// "planner-1 drives r1, r3", "planner-2 took over r1, r3 from planner-1".
class PlannerWatch {
 public:
  /// `tells_first`: also who is the first to drive a robot.
  explicit PlannerWatch(bool tells_first) : tells_first_(tells_first) {}

  /// Folds in an announcement; the line that it is worth, empty for none.
  std::string Fold(const PlannerLease& lease);

 private:
  struct Driver {
    std::uint64_t lease_epoch = 0;
    std::string node;
    std::string instance;
  };
  bool tells_first_;
  std::map<std::string, Driver> drivers_;  // by robot
};

}  // namespace conav::launcher
