#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/protocol/supervision.h"
#include "operator/alerts/alert_book.h"
#include "operator/alerts/conditions.h"
#include "operator/belief/belief_store.h"
#include "operator/desks/service_watch.h"

namespace conav::operators {

/// The alerts of the operator service: on disk before they are shown, also over restarts.
/// Threads: one, the service's.
class AlertDesk {
 public:
  /// `store` outlives it.
  explicit AlertDesk(BeliefStore& store);

  static bool Handles(const OperatorRequest& request);
  /// Requires Handles(request), and that it is no repeat. `now_s`: wall time.
  BeliefStore::Answer Answer(const OperatorRequest& request, double now_s);
  /// All that was looked at.
  void Update(const std::vector<RobotCondition>& robots,
              const std::map<std::string, ServiceStatus>& services,
              const std::optional<std::string>& storage_failure, double now_s);
  /// Alerts that changed since the last call; all of them the first time.
  std::vector<Alert> TakeChanges();

 private:
  BeliefStore& store_;
  AlertBook book_;
  std::vector<Alert> changes_;
};

}  // namespace conav::operators
