#include "operator/desks/service_watch.h"

#include <algorithm>

#include "common/runtime/utf8.h"
#include "operator/alerts/conditions.h"

namespace conav::operators {

void ServiceWatch::Step() {
  const Clock::TimePoint now = clock_.Now();
  for (const auto& array : diagnostics_.Take()) {
    for (const auto& status : array.status()) {
      if (status.hardware_id().empty()) continue;  // not one of conav's
      const std::string name = Readable(status.hardware_id());
      const auto level = std::min<int>(status.level(), static_cast<int>(Health::Level::kError));
      services_[name] = {name, static_cast<Health::Level>(level), Readable(status.message()), now,
                         false};
    }
  }
  for (auto& [name, service] : services_) service.silent = now - service.heard_at > kSilentAfter;
}

}  // namespace conav::operators
