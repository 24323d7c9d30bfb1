#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "common/bus/backend.h"
#include "common/bus/event_log.h"

namespace conav::bus {

/// The way of a payload from a vendor's receive thread into a Sink: decoded into a message that is
/// used again for the next payload (so that strings and sequences keep their memory), or dropped
/// and counted. Never throws.
/// Threads: safe to call concurrently, also from within the sink.
class Intake {
 public:
  Intake(const EndpointOptions& endpoint, Sink sink, EventLog& events)
      : endpoint_(endpoint), sink_(std::move(sink)), events_(events) {}
  ~Intake() { Release(nullptr); }
  Intake(const Intake&) = delete;
  Intake& operator=(const Intake&) = delete;

  /// CDR with encapsulation.
  void Deliver(std::span<const std::uint8_t> payload, SourceTime source) noexcept;

  /// The two halves of Deliver, for a vendor that decodes by itself: a message to decode into, and
  /// what became of it.
  void* Acquire();
  void Accept(void* message, SourceTime source) noexcept;
  void Refuse(void* message) noexcept;
  void Discard(void* message) noexcept { Release(message); }

  const EndpointOptions& endpoint() const { return endpoint_; }
  std::uint64_t malformed() const { return malformed_; }

 private:
  void Release(void* message) noexcept;

  EndpointOptions endpoint_;
  Sink sink_;
  EventLog& events_;
  std::atomic<void*> spare_{nullptr};
  std::atomic<std::uint64_t> malformed_{0};
};

}  // namespace conav::bus
