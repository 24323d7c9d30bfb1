#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/msg/robot.h"
#include "common/runtime/result.h"

namespace conav {

/// What an empty list means.
enum class NoRobots { kRefused, kAllowed };

/// Parses the entries "world/robot" of a config's `robots` into robot -> world. Throws
/// StartupError, naming the `service`, for another form, an invalid name (the sim rejects the same
/// ones), a repeated robot and, unless allowed, an empty list.
inline std::map<std::string, std::string> WorldOfRobot(const std::string& service,
                                                       const std::vector<std::string>& robots,
                                                       NoRobots none = NoRobots::kRefused) {
  std::map<std::string, std::string> world_of_robot;
  for (const std::string& entry : robots) {
    const auto slash = entry.find('/');
    const std::string world = entry.substr(0, slash);
    const std::string robot = slash == std::string::npos ? "" : entry.substr(slash + 1);
    if (!IsEntityName(world) || !IsEntityName(robot)) {
      throw StartupError(service + ".robots: '" + entry +
                         "' is not \"world/robot\", each 1 to 64 of A-Z a-z 0-9 _");
    }
    if (!world_of_robot.emplace(robot, world).second) {
      throw StartupError(service + ".robots: robot '" + robot + "' appears twice");
    }
  }
  if (world_of_robot.empty() && none == NoRobots::kRefused)
    throw StartupError(service + ".robots: no robots");
  return world_of_robot;
}

}  // namespace conav
