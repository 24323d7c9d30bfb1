#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "common/bus/subscriber.h"
#include "common/msg/supervision.h"
#include "common/runtime/clock.h"
#include "common/service/diagnostics.h"
#include "operator/belief/belief_store.h"
#include "operator/supervision/alerts.h"

namespace conav::operators {

/// The newest report of a process on /diagnostics.
struct ServiceStatus {
  std::string name;
  Health::Level level = Health::Level::kOk;
  std::string message;
  Clock::TimePoint received_at{};
  bool silent = false;  // for longer than kSilentAfter
};

/// Listens to the health of conav's processes; those of others on /diagnostics are left out.
/// Threads: one.
class ServiceMonitor {
 public:
  ServiceMonitor(bus::Participant& participant, const Clock& clock)
      : clock_(clock), diagnostics_(participant, bus::kDiagnostics) {}

  void Step();
  /// By name.
  const std::map<std::string, ServiceStatus>& services() const { return services_; }

 private:
  const Clock& clock_;
  bus::Subscriber<diagnostic_msgs::msg::DiagnosticArray> diagnostics_;
  std::map<std::string, ServiceStatus> services_;
};

/// The alerts of the operator service: on disk before they are shown, also over restarts.
/// Threads: one, the service's.
class AlertTopics {
 public:
  /// `store` outlives it.
  explicit AlertTopics(BeliefStore& store);

  static bool Handles(const OperatorRequest& request);
  /// Requires Handles(request), and that it is no repeat. `now_s`: wall time.
  BeliefStore::Answer Answer(const OperatorRequest& request, double now_s);
  /// Raises and ends alerts.
  void Update(const std::vector<RobotCondition>& robots,
              const std::map<std::string, ServiceStatus>& services,
              const std::optional<std::string>& storage_failure, double now_s);
  /// Alerts that changed since the last call; all of them the first time.
  std::vector<Alert> TakeChanges();

 private:
  BeliefStore& store_;
  AlertRegistry registry_;
  std::vector<Alert> changes_;
};

}  // namespace conav::operators
