#pragma once

#include <chrono>

namespace conav::bus {

enum class Reliability { kBestEffort, kReliable };
enum class Durability { kVolatile, kTransientLocal };

/// DDS QoS as far as the bus uses it. `depth` is keep-last; 0 = keep all, bounded by kKeepAllLimit
/// samples.
struct Qos {
  Reliability reliability = Reliability::kReliable;
  Durability durability = Durability::kVolatile;
  int depth = 10;
};

inline constexpr int kKeepAllLimit = 500;

/// The profiles of the topic table. ROS 2 tools accept each of them (rclcpp's defaults are
/// compatible).
inline constexpr Qos kDefaultQos{};
inline constexpr Qos kSensorQos{Reliability::kBestEffort, Durability::kVolatile, 5};
inline constexpr Qos kClockQos{Reliability::kBestEffort, Durability::kVolatile, 1};
inline constexpr Qos kTransformQos{Reliability::kReliable, Durability::kVolatile, 100};
/// State, maps, commands: a late joiner gets the newest.
inline constexpr Qos kLatchedQos{Reliability::kReliable, Durability::kTransientLocal, 1};
/// Orders that nobody is to carry out late: no late joiner gets one, and a newer one replaces it.
inline constexpr Qos kNewestQos{Reliability::kReliable, Durability::kVolatile, 1};
/// Things of which each one counts: a late joiner gets the last hundred.
inline constexpr Qos kEventQos{Reliability::kReliable, Durability::kTransientLocal, 100};
/// Requests and replies with ids; whoever asks repeats until answered.
inline constexpr Qos kRequestQos{Reliability::kReliable, Durability::kVolatile, 0};
/// The same where an old one is of no use and several answer: who hangs or was killed holds nobody
/// up, as it would with keep all until its lease ends.
inline constexpr Qos kQueryQos{Reliability::kReliable, Durability::kVolatile, 32};

}  // namespace conav::bus
