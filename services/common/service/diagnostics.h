#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/publisher.h"
#include "common/runtime/clock.h"
#include "ros2_interfaces.h"

namespace conav {

/// Wall time as ROS 2 writes it. For simulation time see common/msg/convert.h.
inline builtin_interfaces::msg::Time RosWallTime(std::chrono::system_clock::time_point time) {
  const auto since_epoch = time.time_since_epoch();
  const auto seconds = std::chrono::floor<std::chrono::seconds>(since_epoch);
  builtin_interfaces::msg::Time stamp;
  stamp.sec(static_cast<std::int32_t>(seconds.count()));
  stamp.nanosec(static_cast<std::uint32_t>(
      std::chrono::duration_cast<std::chrono::nanoseconds>(since_epoch - seconds).count()));
  return stamp;
}

/// A service's health in the terms of diagnostic_msgs (REP-107).
struct Health {
  enum class Level : std::uint8_t { kOk, kWarning, kError };
  Level level = Level::kOk;
  std::string message;
  std::vector<std::pair<std::string, std::string>> values;
};

/// Tells systemd "READY=1", "WATCHDOG=1" or "STOPPING=1" (sd_notify(3)), where the environment has
/// its NOTIFY_SOCKET; elsewhere does nothing.
void NotifySystemd(std::string_view state);

/// Publishes a service's health on /diagnostics each kPeriod of wall time: the heartbeat by which
/// others notice that it is silent or has started again. Where nobody asks for that (bus::Demand) each
/// kSparsePeriod, with its values at the start and about each kValuesPeriod.
class Diagnostics {
 public:
  static constexpr std::chrono::milliseconds kPeriod{500};
  static constexpr std::chrono::milliseconds kSparsePeriod{800};
  static constexpr std::chrono::seconds kValuesPeriod{5};

  Diagnostics(bus::Participant& participant, const Clock& clock)
      : name_(participant.node_name()),
        started_(std::to_string(std::chrono::system_clock::now().time_since_epoch().count())),
        clock_(clock),
        publisher_(participant, bus::kDiagnostics) {}

  /// Call often, from the service's own thread: when due it asks for the health and publishes it, and
  /// feeds systemd's watchdog.
  void Tick(const std::function<Health()>& health);

 private:
  std::string name_;
  std::string started_;
  const Clock& clock_;
  bus::Publisher<diagnostic_msgs::msg::DiagnosticArray> publisher_;
  Clock::TimePoint next_{};
};

/// The health that a process reports on /diagnostics.
struct ReportedHealth {
  std::string process;
  Health::Level level = Health::Level::kOk;
  std::string message;
  std::string started;  // differs after each start; empty from other versions
};

/// The reports of conav's processes only. Names and messages are made Readable(); the level that
/// REP-107 ranks above an error (stale) counts as an error.
std::vector<ReportedHealth> HealthOf(const diagnostic_msgs::msg::DiagnosticArray& message);

}  // namespace conav
