#include "common/bus/events.h"

#include <exception>
#include <map>

namespace conav::bus {
namespace {

constexpr std::size_t kSystemShown = 64;

void LogEvent(const Event& event) {
  using Kind = Event::Kind;
  if (event.kind == Kind::kIncompatibleQos) {
    LOG_WARNING("incompatible QoS", "topic", event.topic, "policy", event.detail);
  } else if (event.kind == Kind::kOtherSystem) {
    LOG_WARNING("another system is in this DDS domain; its messages are ignored", "system",
                event.detail, "topic", event.topic);
  } else if (event.kind == Kind::kLivelinessLost) {
    LOG_WARNING("liveliness lost", "topic", event.topic);
  } else {
    LOG_DEBUG(event.kind == Kind::kMatched     ? "matched"
              : event.kind == Kind::kUnmatched ? "unmatched"
                                               : "liveliness gained",
              "topic", event.topic);
  }
}

std::string PolicyName(std::uint32_t policy) {
  static const std::map<std::uint32_t, std::string> names = {
      {2, "durability"},         {4, "deadline"},
      {5, "latency budget"},     {6, "ownership"},
      {8, "liveliness"},         {11, "reliability"},
      {12, "destination order"}, {23, "data representation"}};
  const auto found = names.find(policy);
  return found != names.end() ? found->second : "policy " + std::to_string(policy);
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

void EventLog::OtherSystem(const std::string& topic, const std::string& system) {
  {
    const std::lock_guard lock(mutex_);
    if (other_systems_.size() >= kSystemLimit || !other_systems_.insert(system).second) return;
  }
  Add({Event::Kind::kOtherSystem, topic, system});
}

void EventLog::Malformed(const EndpointOptions& endpoint, std::uint64_t count) {
  if (!malformed_logged_.Allow()) return;
  LOG_WARNING("malformed payload dropped", "topic", endpoint.topic, "type", endpoint.type.name,
              "count", count);
}

void EndpointEvents::Matched(int change) noexcept {
  if (change > 0) Add(Event::Kind::kMatched, {});
  if (change < 0) Add(Event::Kind::kUnmatched, {});
}

void EndpointEvents::Liveliness(int alive_change, int not_alive_change) noexcept {
  if (not_alive_change > 0) Add(Event::Kind::kLivelinessLost, {});
  if (alive_change > 0) Add(Event::Kind::kLivelinessGained, {});
}

void EndpointEvents::OtherSystem(std::string_view system) noexcept try {
  log_.OtherSystem(topic_, std::string(system.substr(0, kSystemShown)));
} catch (const std::exception&) {
}

void EndpointEvents::IncompatibleQos(std::uint32_t policy) noexcept try {
  Add(Event::Kind::kIncompatibleQos, PolicyName(policy));
} catch (const std::exception&) {
}

void EndpointEvents::Add(Event::Kind kind, const std::string& detail) noexcept try {
  log_.Add({kind, topic_, detail});
} catch (const std::exception&) {
  // Out of memory: drop the event.
}

}  // namespace conav::bus
