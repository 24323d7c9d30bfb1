#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "common/bus/backend.h"
#include "common/bus/events.h"

namespace conav::bus {

/// Removes duplicate samples. When a link was cut and restored, a transient-local writer sends its
/// history again, and a reader that takes at once cannot tell. So this remembers the last stamps
/// (sequence numbers or source timestamps) of each writer, a few more than its history.
/// Threads: one at a time.
class Deduplicator {
 public:
  static constexpr std::size_t kWindow = 512;  // more than any history of the topic table
  static constexpr std::size_t kMargin = 16;   // a ROS 2 node may keep more than the topic table
  static constexpr std::size_t kWriters = 256;

  /// `depth`: as Qos::depth.
  explicit Deduplicator(int depth = 0)
      : window_(depth > 0 ? static_cast<std::size_t>(depth) + kMargin : kWindow) {}

  /// True unless `stamp` is among the last stamps of `writer`.
  bool IsNew(const Guid& writer, std::int64_t stamp);

  /// Of all stamps that are remembered.
  std::size_t bytes() const;

 private:
  struct Window {
    Guid writer;
    std::vector<std::int64_t> stamps;  // a ring once it is full
    std::size_t oldest = 0;
  };

  Window& WindowOf(const Guid& writer);

  std::size_t window_;           // stamps
  std::vector<Window> windows_;  // most recently used last
};

/// Passes payloads from a vendor's receive thread to a Sink. Decodes each into a reused message (so
/// that strings and sequences keep their memory), or drops and counts it. Never throws.
/// Threads: safe to call concurrently, also from within the sink.
class Intake {
 public:
  Intake(const EndpointOptions& endpoint, Sink sink, EventLog& events)
      : endpoint_(endpoint), sink_(std::move(sink)), events_(events) {}
  ~Intake() { Release(nullptr); }
  Intake(const Intake&) = delete;
  Intake& operator=(const Intake&) = delete;

  /// CDR with encapsulation.
  void Deliver(std::span<const std::uint8_t> payload, const Origin& origin) noexcept;

  /// The two halves of Deliver, for a vendor that decodes by itself: first a message to decode
  /// into, then Accept or Refuse.
  void* Acquire();
  void Accept(void* message, const Origin& origin) noexcept;
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
