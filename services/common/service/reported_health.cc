#include "common/service/reported_health.h"

#include <algorithm>

#include "common/runtime/utf8.h"

namespace conav {

std::vector<ReportedHealth> HealthOf(const diagnostic_msgs::msg::DiagnosticArray& message) {
  std::vector<ReportedHealth> all;
  for (const auto& status : message.status()) {
    if (status.hardware_id().empty()) continue;  // not one of conav's
    const auto level = std::min<int>(status.level(), static_cast<int>(Health::Level::kError));
    all.push_back({Readable(status.hardware_id()), static_cast<Health::Level>(level),
                   Readable(status.message())});
  }
  return all;
}

}  // namespace conav
