#pragma once

#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "common/bus/backend.h"

// One user: the bus of the tests, chosen like a vendor.

namespace conav::bus {

class InMemoryTopic;

/// A bus inside one process, for tests. The participants of a test share it.
///
///   auto bus = std::make_shared<InMemoryBus>();
///   Participant sim("sim", bus), planner("planner", bus);
///
/// Same contract as DDS: every message is serialised and deserialised, QoS decides what matches,
/// transient-local writers send their history (depth samples) to late readers, connection events
/// appear on both sides (except kLivelinessLost and kLivelinessGained: nothing dies or stalls
/// here). When a handler throws, the bus logs it and delivers the next message. The publishing
/// thread delivers before Publish() returns. When a handler publishes, or two threads publish at
/// once, one reader still gets one message at a time and in order, so a nested or concurrent
/// message may arrive after its own Publish() returned. Keys are ignored: history depth is per
/// writer, not per instance.
class InMemoryBus {
 public:
  InMemoryBus();
  ~InMemoryBus();
  InMemoryBus(const InMemoryBus&) = delete;
  InMemoryBus& operator=(const InMemoryBus&) = delete;

  /// The topic of that name, created on first use. Lives as long as the bus.
  InMemoryTopic& TopicNamed(const std::string& name);

  /// Backdates the source time of all later messages by `delay`.
  void SetSourceDelay(std::chrono::nanoseconds delay) { source_delay_ = delay; }
  SourceTime source_time() const {
    return std::chrono::system_clock::now() -
           std::chrono::duration_cast<SourceTime::duration>(source_delay_.load());
  }
  /// For participants made from now on: Participant::over_link(). Delivery stays the same.
  void SetOverLink() { over_link_ = true; }
  bool over_link() const { return over_link_; }
  /// Of the next participant; its writers' differ from it in the last four bytes only, as in DDS.
  Guid NewGuid();

 private:
  std::atomic<std::uint64_t> guids_{0};
  std::atomic<bool> over_link_ = false;
  std::atomic<std::chrono::nanoseconds> source_delay_{std::chrono::nanoseconds(0)};
  std::mutex mutex_;  // guards topics_
  std::map<std::string, std::unique_ptr<InMemoryTopic>> topics_;
};

/// Connects a participant to `bus`.
std::unique_ptr<Backend> MakeInMemoryBackend(std::shared_ptr<InMemoryBus> bus);

}  // namespace conav::bus
