#include "planner/config.h"

#include <fmt/format.h>

namespace conav::planner {

std::map<std::string, std::string> WorldOfRobot(const PlannerConfig& config) {
  std::map<std::string, std::string> world_of_robot;
  for (const std::string& entry : config.robots) {
    const auto slash = entry.find('/');
    if (slash == std::string::npos || slash == 0 || slash + 1 == entry.size()) {
      throw StartupError(fmt::format("planner.robots: '{}' is not \"world/robot\"", entry));
    }
    const std::string robot = entry.substr(slash + 1);
    if (!world_of_robot.emplace(robot, entry.substr(0, slash)).second) {
      throw StartupError(fmt::format("planner.robots: robot '{}' stands there twice", robot));
    }
  }
  if (world_of_robot.empty()) throw StartupError("planner.robots: no robots to drive");
  return world_of_robot;
}

}  // namespace conav::planner
