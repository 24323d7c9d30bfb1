#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

#include "common/bus/backend.h"
#include "common/runtime/log_limit.h"

namespace conav::bus {

/// Collects the connection events of one participant and writes a log line for each: a warning for
/// incompatible QoS and lost liveliness, debug for the rest.
/// Threads: safe to call concurrently; called from receive threads.
class EventLog {
 public:
  void Add(Event event);
  /// The events since the last call, oldest first; at most kLimit, the oldest are forgotten.
  std::vector<Event> Take();

  /// Logs a payload that was dropped, at most once a second over all topics.
  void Malformed(const EndpointOptions& endpoint, std::uint64_t count);

  static constexpr std::size_t kLimit = 1000;

 private:
  LogLimit malformed_logged_;
  std::mutex mutex_;  // guards events_
  std::vector<Event> events_;
};

}  // namespace conav::bus
