#include "common/service/diagnostics.h"

#include <algorithm>

#include "common/runtime/log.h"
#include "common/runtime/text.h"

namespace conav {

void Diagnostics::Tick(const std::function<Health()>& health) {
  const Clock::TimePoint now = clock_.Now();
  if (now < next_) return;
  next_ = now + std::chrono::seconds(1);
  const Health state = health();
  diagnostic_msgs::msg::DiagnosticStatus status;
  status.level(static_cast<std::uint8_t>(state.level));
  status.name(name_ + ": health");
  status.message(state.message);
  status.hardware_id(name_);
  for (const auto& [key, value] : state.values) {
    diagnostic_msgs::msg::KeyValue pair;
    pair.key(key);
    pair.value(value);
    status.values().push_back(std::move(pair));
  }
  diagnostic_msgs::msg::DiagnosticArray array;
  array.header().stamp(RosWallTime(std::chrono::system_clock::now()));
  array.status().push_back(std::move(status));
  if (const auto sent = publisher_.Publish(array); !sent) {
    LOG_WARNING("diagnostics not sent", "reason", sent.error().text);
  }
}

std::vector<ReportedHealth> HealthOf(const diagnostic_msgs::msg::DiagnosticArray& message) {
  std::vector<ReportedHealth> all;
  for (const auto& status : message.status()) {
    if (status.hardware_id().empty()) continue;  // not a conav process
    const auto level = std::min<int>(status.level(), static_cast<int>(Health::Level::kError));
    all.push_back({Readable(status.hardware_id()), static_cast<Health::Level>(level),
                   Readable(status.message())});
  }
  return all;
}

}  // namespace conav
