#include "common/bus/endpoint_events.h"

#include <exception>
#include <map>

namespace conav::bus {
namespace {

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

void EndpointEvents::Matched(int change) noexcept {
  if (change > 0) Add(Event::Kind::kMatched, {});
  if (change < 0) Add(Event::Kind::kUnmatched, {});
}

void EndpointEvents::Liveliness(int alive_change, int not_alive_change) noexcept {
  if (not_alive_change > 0) Add(Event::Kind::kLivelinessLost, {});
  if (alive_change > 0) Add(Event::Kind::kLivelinessGained, {});
}

void EndpointEvents::IncompatibleQos(std::uint32_t policy) noexcept try {
  Add(Event::Kind::kIncompatibleQos, PolicyName(policy));
} catch (const std::exception&) {
}

void EndpointEvents::Add(Event::Kind kind, const std::string& detail) noexcept try {
  log_.Add({kind, topic_, detail});
} catch (const std::exception&) {
  // out of memory: an event less
}

}  // namespace conav::bus
