#pragma once

#include <chrono>

#include "ros2_interfaces.h"

namespace conav {

/// Wall time as ROS 2 writes it. Simulation time has its own conversion, in common/protocol.
inline builtin_interfaces::msg::Time RosWallTime(std::chrono::system_clock::time_point time) {
  const auto since_epoch = time.time_since_epoch();
  const auto seconds = std::chrono::floor<std::chrono::seconds>(since_epoch);
  builtin_interfaces::msg::Time stamp;
  stamp.sec(static_cast<std::int32_t>(seconds.count()));
  stamp.nanosec(static_cast<std::uint32_t>(
      std::chrono::duration_cast<std::chrono::nanoseconds>(since_epoch - seconds).count()));
  return stamp;
}

}  // namespace conav
