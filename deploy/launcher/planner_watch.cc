#include "launcher/planner_watch.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>
#include <vector>

namespace conav::launcher {

std::string PlannerWatch::Fold(const PlannerLease& lease) {
  std::vector<std::string> robots;
  std::set<std::string> before;
  for (const PlannerLease::Held& held : lease.holds) {
    Driver& driver = drivers_[held.robot];
    if (held.lease_epoch <= driver.lease_epoch) continue;
    if (driver.instance != lease.instance) {
      robots.push_back(held.robot);
      if (!driver.node.empty()) before.insert(driver.node);
    }
    driver = {held.lease_epoch, lease.node, lease.instance};
  }
  if (robots.empty() || (before.empty() && !tells_first_)) return "";
  if (before.empty()) return fmt::format("{} drives {}", lease.node, fmt::join(robots, ", "));
  return fmt::format("{} took over {} from {}", lease.node, fmt::join(robots, ", "),
                     fmt::join(before, ", "));
}

}  // namespace conav::launcher
