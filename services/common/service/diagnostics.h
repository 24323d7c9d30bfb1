#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/runtime/clock.h"
#include "ros2_interfaces.h"

namespace conav {

/// Wall time as ROS 2 writes it: since 1970 or, of a monotonic clock, since its start. For simulation time
/// see common/msg/convert.h.
inline builtin_interfaces::msg::Time RosWallTime(std::chrono::nanoseconds since_epoch) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(since_epoch);
  builtin_interfaces::msg::Time stamp;
  stamp.sec(static_cast<std::int32_t>(seconds.count()));
  stamp.nanosec(static_cast<std::uint32_t>((since_epoch - seconds).count()));
  return stamp;
}
inline builtin_interfaces::msg::Time RosWallTime(std::chrono::system_clock::time_point time) {
  return RosWallTime(std::chrono::nanoseconds(time.time_since_epoch()));
}
inline std::chrono::nanoseconds ToDuration(const builtin_interfaces::msg::Time& time) {
  return std::chrono::seconds(time.sec()) + std::chrono::nanoseconds(time.nanosec());
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
/// kSparsePeriod, with its values at the start and about each kValuesPeriod. A report also answers the
/// newest clock probe since the one before.
class Diagnostics {
 public:
  static constexpr std::chrono::milliseconds kPeriod{500};
  static constexpr std::chrono::milliseconds kSparsePeriod{800};
  static constexpr std::chrono::seconds kValuesPeriod{5};
  /// The time of day on this host; tests set it wrong.
  using TimeOfDay = std::function<std::chrono::system_clock::time_point()>;

  Diagnostics(bus::Participant& participant, const Clock& clock,
              TimeOfDay time_of_day = std::chrono::system_clock::now);

  /// Call often, from the service's own thread: when due it asks for the health and publishes it, and
  /// feeds systemd's watchdog.
  void Tick(const std::function<Health()>& health);

 private:
  /// The answer to the newest probe, as a value of the report; empty without one.
  std::string TakeClockAnswer();

  std::string name_;
  std::string started_;
  const Clock& clock_;
  const TimeOfDay time_of_day_;
  bus::Publisher<diagnostic_msgs::msg::DiagnosticArray> publisher_;
  Clock::TimePoint next_{};
  Clock::TimePoint values_due_{};
  std::mutex mutex_;  // guards clock_answer_
  std::string clock_answer_;
  bus::Subscriber<rosgraph_msgs::msg::Clock> probes_;  // last: its handler uses the other members
};

/// The answer to a clock probe. Times in s.
struct ClockAnswer {
  std::chrono::nanoseconds asked{};  // what the probe said
  double received_s = 0.0;           // by the clock of the host that answers, since 1970; likewise:
  double sent_s = 0.0;
  std::string host;
};

/// The health that a process reports on /diagnostics.
struct ReportedHealth {
  std::string process;
  Health::Level level = Health::Level::kOk;
  std::string message;
  std::string started;  // differs after each start; empty from other versions
  std::optional<ClockAnswer> clock;
};

/// Whether a report has more than its process's start and the answer to a clock probe.
bool HasValues(const diagnostic_msgs::msg::DiagnosticStatus& status);

/// The reports of conav's processes only. Names and messages are made Readable(); the level that
/// REP-107 ranks above an error (stale) counts as an error.
std::vector<ReportedHealth> HealthOf(const diagnostic_msgs::msg::DiagnosticArray& message);

}  // namespace conav
