#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "common/bus/subscriber.h"
#include "common/runtime/clock.h"
#include "common/service/diagnostics.h"

namespace conav::operators {

/// How a process is, as it said last on /diagnostics.
struct ServiceStatus {
  std::string name;
  Health::Level level = Health::Level::kOk;
  std::string message;
  Clock::TimePoint heard_at{};
  bool silent = false;  // for longer than kSilentAfter
};

/// Listens to the health of conav's processes; those of others on /diagnostics are left out.
/// Threads: one.
class ServiceWatch {
 public:
  ServiceWatch(bus::Participant& participant, const Clock& clock)
      : clock_(clock), diagnostics_(participant, bus::kDiagnostics) {}

  void Step();
  /// By name.
  const std::map<std::string, ServiceStatus>& services() const { return services_; }

 private:
  const Clock& clock_;
  bus::Subscriber<diagnostic_msgs::msg::DiagnosticArray> diagnostics_;
  std::map<std::string, ServiceStatus> services_;
};

}  // namespace conav::operators
