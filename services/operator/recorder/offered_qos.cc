#include "operator/recorder/offered_qos.h"

#include <fmt/format.h>

namespace conav::recorder {
namespace {

// rmw_qos_history_policy_t and so on.
constexpr int kKeepLast = 1;
constexpr int kKeepAll = 2;
constexpr int kReliable = 1;
constexpr int kBestEffort = 2;
constexpr int kTransientLocal = 1;
constexpr int kVolatile = 2;

/// "Infinite" as rmw has it: the most nanoseconds in 64 bits.
constexpr const char* kNever = "{sec: 9223372036, nsec: 854775807}";

}  // namespace

std::string OfferedQosText(const bus::Qos& qos) {
  const bool reliable = qos.reliability == bus::Reliability::kReliable;
  const bool latched = qos.durability == bus::Durability::kTransientLocal;
  return fmt::format(
      "- history: {}\n  depth: {}\n  reliability: {}\n  durability: {}\n  deadline: {}\n"
      "  lifespan: {}\n  liveliness: 1\n  liveliness_lease_duration: {}\n"
      "  avoid_ros_namespace_conventions: false\n",
      qos.depth > 0 ? kKeepLast : kKeepAll, qos.depth, reliable ? kReliable : kBestEffort,
      latched ? kTransientLocal : kVolatile, kNever, kNever, kNever);
}

}  // namespace conav::recorder
