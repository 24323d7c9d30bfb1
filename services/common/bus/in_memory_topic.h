#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <vector>

#include "common/bus/backend.h"
#include "common/bus/event_log.h"
#include "common/bus/intake.h"

namespace conav::bus {

/// One serialised message, shared by the queues that hold it.
struct InMemorySample {
  std::vector<std::uint8_t> bytes;
  SourceTime source;
};
using InMemoryPayload = std::shared_ptr<const InMemorySample>;

/// What writers and readers of the in-memory bus have in common.
struct InMemoryEndpoint {
  InMemoryEndpoint(const EndpointOptions& endpoint_options, std::shared_ptr<EventLog> event_log)
      : options(endpoint_options), events(std::move(event_log)) {}
  EndpointOptions options;
  std::shared_ptr<EventLog> events;
  std::atomic<int> matched{0};
};

struct InMemoryWriterState : InMemoryEndpoint {
  using InMemoryEndpoint::InMemoryEndpoint;
  std::deque<InMemoryPayload> history;  // guarded by the topic's mutex
};

/// Delivers payloads one at a time and in order, on whichever thread found the reader idle.
class InMemoryReaderState : public InMemoryEndpoint {
 public:
  InMemoryReaderState(const EndpointOptions& options, std::shared_ptr<EventLog> events, Sink sink)
      : InMemoryEndpoint(options, std::move(events)),
        intake_(options, std::move(sink), *this->events) {}

  void Enqueue(InMemoryPayload payload);
  /// Delivers what is queued, unless another thread (or this one, further up) is about it.
  void Drain();
  /// No delivery any more, and none under way, when this returns.
  void Close();
  std::uint64_t malformed() const { return intake_.malformed(); }

 private:
  Intake intake_;
  std::mutex mutex_;  // guards what follows
  std::condition_variable idle_;
  std::deque<InMemoryPayload> queue_;
  bool delivering_ = false;
  bool closed_ = false;
};

class InMemoryTopic {
 public:
  void Add(const std::shared_ptr<InMemoryWriterState>& writer);
  void Add(const std::shared_ptr<InMemoryReaderState>& reader);
  void Remove(const std::shared_ptr<InMemoryWriterState>& writer);
  void Remove(const std::shared_ptr<InMemoryReaderState>& reader);
  void Write(InMemoryWriterState& writer, InMemoryPayload payload);

 private:
  std::mutex mutex_;  // guards writers_, readers_ and the writers' histories
  std::vector<std::shared_ptr<InMemoryWriterState>> writers_;
  std::vector<std::shared_ptr<InMemoryReaderState>> readers_;
};

}  // namespace conav::bus
