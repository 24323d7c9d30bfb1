#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

/// What each program of conav may publish and subscribe to, by the table of topics and that of services.
namespace conav::keystore {

/// Of the launcher and of tools (RViz, `ros2`, `conav doctor`) there is one each; the others are services.
inline constexpr std::array<std::string_view, 9> kRoles{
    "sim",      "driver", "nhpm", "operator", "planner", "recorder", "simulated_operator",
    "launcher", "tools"};

/// Patterns of DDS topic names; "never" comes first.
struct Grant {
  std::vector<std::string> publish;
  std::vector<std::string> subscribe;
  std::vector<std::string> never_publish;
  std::vector<std::string> never_subscribe;
};

struct GrantOptions {
  /// What the role sends about a robot, and what is sent to a robot, is of these only; none = of all.
  std::vector<std::string> robots;
  /// ROS names of other topics and actions that it may use: those of a driver's robot.
  std::vector<std::string> topics;
};

/// The operator, the recorder, the launcher and tools may read every topic.
Grant GrantOf(std::string_view role, const GrantOptions& options);

/// The roles that the side of a "from -> to" in the table of topics names. Throws StartupError for a word
/// that it does not know.
std::vector<std::string_view> RolesIn(std::string_view side);

/// DDS security's permissions of one subject in the domains 0 to 230 (the most that Cyclone DDS knows of), valid until `end` ("2036-11-24T00:00:00").
std::string PermissionsXml(const Grant& grant, const std::string& enclave,
                           const std::string& subject, const std::string& end);

/// SROS2's default: everything is authenticated, encrypted and subject to permissions.
std::string GovernanceXml();

}  // namespace conav::keystore
