#pragma once

#include <cstdint>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/backend.h"
#include "common/runtime/log.h"

namespace conav::bus {

/// Collects the connection events of one participant and writes a log line for each: a warning for
/// incompatible QoS and lost liveliness, debug for the rest.
/// Threads: safe to call concurrently; called from receive threads.
class EventLog {
 public:
  void Add(Event event);
  /// The events since the last call, oldest first. Keeps the newest kLimit.
  std::vector<Event> Take();

  /// Adds an event and warns the first time, for at most kSystemLimit systems.
  void OtherSystem(const std::string& topic, const std::string& system);

  /// Logs a dropped payload, at most once a second over all topics.
  void Malformed(const EndpointOptions& endpoint, std::uint64_t count);

  static constexpr std::size_t kLimit = 1000;
  static constexpr std::size_t kSystemLimit = 100;

 private:
  LogLimit malformed_logged_;
  std::mutex mutex_;  // guards what follows
  std::vector<Event> events_;
  std::set<std::string> other_systems_;
};

/// Turns the vendors' reports about one writer or reader into Events. Never throws.
/// Threads: as EventLog.
class EndpointEvents {
 public:
  EndpointEvents(EventLog& log, std::string topic) : log_(log), topic_(std::move(topic)) {}

  /// `change` is the change in the number of matched, alive or not alive peers since the last
  /// report.
  void Matched(int change) noexcept;
  void Liveliness(int alive_change, int not_alive_change) noexcept;
  /// Matched with an endpoint of another system; logged once for each system and participant.
  void OtherSystem(std::string_view system) noexcept;
  /// `policy` is the number in the DDS specification (DDS 1.4, 2.3.3), equal in both vendors.
  void IncompatibleQos(std::uint32_t policy) noexcept;

  const std::string& topic() const { return topic_; }

 private:
  void Add(Event::Kind kind, const std::string& detail) noexcept;

  EventLog& log_;
  const std::string topic_;
};

}  // namespace conav::bus
