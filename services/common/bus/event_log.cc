#include "common/bus/event_log.h"

#include "common/runtime/log.h"

namespace conav::bus {
namespace {

void LogEvent(const Event& event) {
  switch (event.kind) {
    case Event::Kind::kMatched:
      LOG_DEBUG("matched", "topic", event.topic);
      break;
    case Event::Kind::kUnmatched:
      LOG_DEBUG("unmatched", "topic", event.topic);
      break;
    case Event::Kind::kLivelinessLost:
      LOG_WARNING("liveliness lost", "topic", event.topic);
      break;
    case Event::Kind::kLivelinessGained:
      LOG_DEBUG("liveliness gained", "topic", event.topic);
      break;
    case Event::Kind::kIncompatibleQos:
      LOG_WARNING("incompatible QoS", "topic", event.topic, "policy", event.detail);
      break;
  }
}

}  // namespace

void EventLog::Add(Event event) {
  LogEvent(event);
  const std::lock_guard lock(mutex_);
  if (events_.size() >= kLimit) events_.erase(events_.begin());
  events_.push_back(std::move(event));
}

std::vector<Event> EventLog::Take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(events_, {});
}

void EventLog::Malformed(const EndpointOptions& endpoint, std::uint64_t count) {
  if (!malformed_logged_.Allow()) return;
  LOG_WARNING("malformed payload dropped", "topic", endpoint.topic, "type", endpoint.type.name,
              "count", count);
}

}  // namespace conav::bus
