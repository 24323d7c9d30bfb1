#pragma once

namespace conav::bus {

enum class Reliability { kBestEffort, kReliable };
enum class Durability { kVolatile, kTransientLocal };

/// Of a subscriber: how often it wants the messages of a publisher that can send at two rates, as
/// the simulator its clock and poses. Subscribers of other programs (ROS 2 tools) are kAll. A sparse
/// one gets every message, too; but a publisher does not send more for its sake. kSparseOverLinks is
/// kAll on the loopback interface and kSparse on others.
enum class Demand { kAll, kSparse, kSparseOverLinks };

/// The part of DDS QoS that the bus uses. `depth` is keep-last; 0 = keep all, bounded by
/// kKeepAllLimit samples.
struct Qos {
  Reliability reliability = Reliability::kReliable;
  Durability durability = Durability::kVolatile;
  int depth = 10;
  Demand demand = Demand::kAll;
};

inline constexpr int kKeepAllLimit = 500;

/// The profiles of the topic table. ROS 2 tools accept each of them (rclcpp's defaults are
/// compatible).
inline constexpr Qos kDefaultQos{};
inline constexpr Qos kSensorQos{Reliability::kBestEffort, Durability::kVolatile, 5};
/// Pictures may be lost, but RViz and image_view ask for reliable ones by default. A slow viewer
/// keeps nothing back: only the newest few wait for it.
inline constexpr Qos kImageQos{Reliability::kReliable, Durability::kVolatile, 5};
inline constexpr Qos kClockQos{Reliability::kBestEffort, Durability::kVolatile, 1};
inline constexpr Qos kTransformQos{Reliability::kReliable, Durability::kVolatile, 100};
/// State, maps, commands: a late joiner gets the newest.
inline constexpr Qos kLatchedQos{Reliability::kReliable, Durability::kTransientLocal, 1};
/// Latched messages as changes of one another: the last of them hold a whole one (changes.h).
inline constexpr Qos kChangesQos{Reliability::kReliable, Durability::kTransientLocal, 32};
inline constexpr Qos kHealthQos{Reliability::kReliable, Durability::kVolatile, 10,
                                Demand::kSparseOverLinks};
/// Orders that must not be carried out late: a late joiner gets none, and a newer one replaces the
/// older.
inline constexpr Qos kNewestQos{Reliability::kReliable, Durability::kVolatile, 1};
/// Events that all count: a late joiner gets the last hundred.
inline constexpr Qos kEventQos{Reliability::kReliable, Durability::kTransientLocal, 100};
/// A robot's pictures, 10 kB and more each: its host keeps as many as a late joiner gets.
inline constexpr Qos kSnapshotQos{Reliability::kReliable, Durability::kTransientLocal, 20};
/// Requests and replies with ids; a client repeats its request until the reply comes.
inline constexpr Qos kRequestQos{Reliability::kReliable, Durability::kVolatile, 0};
/// Requests with several servers where an old reply is useless. A server that hangs or was killed
/// delays no client; with keep all it would until its lease ends.
inline constexpr Qos kQueryQos{Reliability::kReliable, Durability::kVolatile, 32};

/// Samples of an eye tracker, hundreds a second: each counts.
inline constexpr Qos kSampleQos{Reliability::kReliable, Durability::kVolatile, 1000};

/// Services and parameters as ROS 2 has them.
inline constexpr Qos kServiceQos{Reliability::kReliable, Durability::kVolatile, 10};
inline constexpr Qos kParameterQos{Reliability::kReliable, Durability::kVolatile, 1000};

}  // namespace conav::bus
