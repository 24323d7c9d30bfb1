#pragma once

#include <cstdint>
#include <string>

#include "common/bus/event_log.h"

namespace conav::bus {

/// Turns what the vendors report about one writer or reader into Events. Never throws.
/// Threads: as EventLog.
class EndpointEvents {
 public:
  EndpointEvents(EventLog& log, std::string topic) : log_(log), topic_(std::move(topic)) {}

  /// Changes of the counts of matched, alive and not alive others since the last report.
  void Matched(int change) noexcept;
  void Liveliness(int alive_change, int not_alive_change) noexcept;
  /// `policy` as numbered in the DDS specification (DDS 1.4, 2.3.3), equal in both vendors.
  void IncompatibleQos(std::uint32_t policy) noexcept;

  const std::string& topic() const { return topic_; }

 private:
  void Add(Event::Kind kind, const std::string& detail) noexcept;

  EventLog& log_;
  const std::string topic_;
};

}  // namespace conav::bus
