#pragma once

#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "common/bus/backend.h"

namespace conav::bus {

class InMemoryTopic;

/// A bus inside one process, for tests: made once, shared by the participants of a test.
///
///   auto bus = std::make_shared<InMemoryBus>();
///   Participant sim("sim", bus), planner("planner", bus);
///
/// Same contract as DDS: every message is serialised and deserialised, QoS decides who matches,
/// transient-local writers hand their history (depth samples) to late readers, connection events
/// appear on both sides (but for kLivelinessLost and kLivelinessGained: nobody dies or stalls
/// here). A handler that throws is logged and the next message delivered. Delivery is done on the
/// publishing thread before Publish() returns; when a handler publishes, or two threads publish at
/// once, one reader still gets one message at a time and in order, so a nested or concurrent
/// message may arrive after its own Publish() returned. Keys are not looked at: history depth is
/// per writer, not per instance.
class InMemoryBus {
 public:
  InMemoryBus();
  ~InMemoryBus();
  InMemoryBus(const InMemoryBus&) = delete;
  InMemoryBus& operator=(const InMemoryBus&) = delete;

  /// The topic of that name, made when needed. Lives as long as the bus.
  InMemoryTopic& TopicNamed(const std::string& name);

  /// From now on messages count as published so long ago.
  void SetSourceDelay(std::chrono::nanoseconds delay) { source_delay_ = delay; }
  SourceTime source_time() const {
    return std::chrono::system_clock::now() -
           std::chrono::duration_cast<SourceTime::duration>(source_delay_.load());
  }

 private:
  std::atomic<std::chrono::nanoseconds> source_delay_{std::chrono::nanoseconds(0)};
  std::mutex mutex_;  // guards topics_
  std::map<std::string, std::unique_ptr<InMemoryTopic>> topics_;
};

/// A participant's door to `bus`.
std::unique_ptr<Backend> MakeInMemoryBackend(std::shared_ptr<InMemoryBus> bus);

}  // namespace conav::bus
