#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/runtime/result.h"

namespace conav {

/// The entries "world/robot" of a config's `robots` as robot -> world. Throws StartupError, naming
/// the `service`, for another form, for a robot that stands twice and for an empty list.
inline std::map<std::string, std::string> WorldOfRobot(const std::string& service,
                                                       const std::vector<std::string>& robots) {
  std::map<std::string, std::string> world_of_robot;
  for (const std::string& entry : robots) {
    const auto slash = entry.find('/');
    if (slash == std::string::npos || slash == 0 || slash + 1 == entry.size()) {
      throw StartupError(service + ".robots: '" + entry + "' is not \"world/robot\"");
    }
    const std::string robot = entry.substr(slash + 1);
    if (!world_of_robot.emplace(robot, entry.substr(0, slash)).second) {
      throw StartupError(service + ".robots: robot '" + robot + "' stands there twice");
    }
  }
  if (world_of_robot.empty()) throw StartupError(service + ".robots: no robots");
  return world_of_robot;
}

}  // namespace conav
