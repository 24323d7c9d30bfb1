#include "operator/desks/service_watch.h"

#include "common/service/reported_health.h"
#include "operator/alerts/conditions.h"

namespace conav::operators {

void ServiceWatch::Step() {
  const Clock::TimePoint now = clock_.Now();
  for (const auto& array : diagnostics_.Take()) {
    for (const ReportedHealth& health : HealthOf(array)) {
      services_[health.process] = {health.process, health.level, health.message, now, false};
    }
  }
  for (auto& [name, service] : services_) service.silent = now - service.heard_at > kSilentAfter;
}

}  // namespace conav::operators
