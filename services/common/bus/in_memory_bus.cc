#include "common/bus/in_memory_bus.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <vector>

#include "common/bus/events.h"
#include "common/bus/intake.h"

namespace conav::bus {

/// One serialised message, shared by the queues that hold it.
struct InMemorySample {
  std::vector<std::uint8_t> bytes;
  Origin origin;
};
using InMemoryPayload = std::shared_ptr<const InMemorySample>;

/// The part that writers and readers of the in-memory bus share.
struct InMemoryEndpoint {
  InMemoryEndpoint(const EndpointOptions& endpoint_options, std::shared_ptr<EventLog> event_log)
      : options(endpoint_options), events(std::move(event_log)) {}
  EndpointOptions options;
  std::shared_ptr<EventLog> events;
  std::atomic<int> matched{0};
  std::atomic<int> sparse{0};  // of a writer's matched readers
};

struct InMemoryWriterState : InMemoryEndpoint {
  using InMemoryEndpoint::InMemoryEndpoint;
  std::deque<InMemoryPayload> history;  // guarded by the topic's mutex
};

/// Delivers payloads one at a time and in order, on the thread that finds the reader idle.
class InMemoryReaderState : public InMemoryEndpoint {
 public:
  InMemoryReaderState(const EndpointOptions& options, std::shared_ptr<EventLog> events, Sink sink)
      : InMemoryEndpoint(options, std::move(events)),
        intake_(options, std::move(sink), *this->events) {}

  void Enqueue(InMemoryPayload payload) {
    const std::lock_guard lock(mutex_);
    if (!closed_) queue_.push_back(std::move(payload));
  }
  /// Delivers the queue, unless another thread (or this one, further up the stack) is doing so.
  void Drain() {
    std::unique_lock lock(mutex_);
    if (delivering_) return;
    delivering_ = true;
    while (!queue_.empty()) {
      const InMemoryPayload payload = std::move(queue_.front());
      queue_.pop_front();
      lock.unlock();
      intake_.Deliver(payload->bytes, payload->origin);
      lock.lock();
    }
    delivering_ = false;
    idle_.notify_all();
  }
  /// When this returns, no delivery is under way and none will follow.
  void Close() {
    std::unique_lock lock(mutex_);
    closed_ = true;
    queue_.clear();
    idle_.wait(lock, [this] { return !delivering_; });
  }
  std::uint64_t malformed() const { return intake_.malformed(); }

 private:
  Intake intake_;
  std::mutex mutex_;  // guards what follows
  std::condition_variable idle_;
  std::deque<InMemoryPayload> queue_;
  bool delivering_ = false;
  bool closed_ = false;
};

namespace {

/// The policy that keeps two endpoints of one type apart; nullptr = they match.
const char* IncompatiblePolicy(const InMemoryEndpoint& writer, const InMemoryEndpoint& reader) {
  const Qos& offered = writer.options.qos;
  const Qos& requested = reader.options.qos;
  if (offered.reliability < requested.reliability) return "reliability";
  return offered.durability < requested.durability ? "durability" : nullptr;
}

/// Matches as DDS does: by type name, then offered against requested QoS.
bool Compatible(const InMemoryEndpoint& writer, const InMemoryEndpoint& reader) {
  return writer.options.type.name == reader.options.type.name &&
         IncompatiblePolicy(writer, reader) == nullptr;
}

void Count(InMemoryEndpoint& endpoint, int change) {
  endpoint.matched += change;
  const auto kind = change > 0 ? Event::Kind::kMatched : Event::Kind::kUnmatched;
  endpoint.events->Add({kind, endpoint.options.topic, {}});
}

void CountReader(InMemoryWriterState& writer, const InMemoryReaderState& reader, int change) {
  Count(writer, change);
  if (reader.options.qos.demand == Demand::kSparse) writer.sparse += change;
}

/// Incompatible QoS is an event on both sides; a different type is silent.
void Connect(InMemoryWriterState& writer, InMemoryReaderState& reader) {
  if (!Compatible(writer, reader)) {
    if (writer.options.type.name != reader.options.type.name) return;
    const char* policy = IncompatiblePolicy(writer, reader);
    writer.events->Add({Event::Kind::kIncompatibleQos, writer.options.topic, policy});
    reader.events->Add({Event::Kind::kIncompatibleQos, reader.options.topic, policy});
    return;
  }
  CountReader(writer, reader, 1);
  Count(reader, 1);
  if (reader.options.qos.durability == Durability::kVolatile) return;
  for (const InMemoryPayload& payload : writer.history) reader.Enqueue(payload);
}

}  // namespace

class InMemoryTopic {
 public:
  void Add(const std::shared_ptr<InMemoryWriterState>& writer) {
    const std::lock_guard lock(mutex_);
    writers_.push_back(writer);
    for (const auto& reader : readers_) Connect(*writer, *reader);
  }
  void Add(const std::shared_ptr<InMemoryReaderState>& reader) {
    {
      const std::lock_guard lock(mutex_);
      readers_.push_back(reader);
      for (const auto& writer : writers_) Connect(*writer, *reader);
    }
    reader->Drain();
  }
  void Remove(const std::shared_ptr<InMemoryWriterState>& writer) {
    const std::lock_guard lock(mutex_);
    std::erase(writers_, writer);
    for (const auto& reader : readers_) {
      if (Compatible(*writer, *reader)) Count(*reader, -1);
    }
  }
  void Remove(const std::shared_ptr<InMemoryReaderState>& reader) {
    {
      const std::lock_guard lock(mutex_);
      std::erase(readers_, reader);
      for (const auto& writer : writers_) {
        if (Compatible(*writer, *reader)) CountReader(*writer, *reader, -1);
      }
    }
    reader->Close();
  }
  void Write(InMemoryWriterState& writer, InMemoryPayload payload) {
    std::vector<std::shared_ptr<InMemoryReaderState>> targets;
    {
      const std::lock_guard lock(mutex_);
      const Qos& qos = writer.options.qos;
      if (qos.durability == Durability::kTransientLocal) {
        const auto depth = static_cast<std::size_t>(qos.depth > 0 ? qos.depth : kKeepAllLimit);
        if (writer.history.size() >= depth) writer.history.pop_front();
        writer.history.push_back(payload);
      }
      for (const auto& reader : readers_) {
        if (!Compatible(writer, *reader)) continue;
        reader->Enqueue(payload);
        targets.push_back(reader);
      }
    }
    for (const auto& reader : targets) reader->Drain();
  }

 private:
  std::mutex mutex_;  // guards writers_, readers_ and the writers' histories
  std::vector<std::shared_ptr<InMemoryWriterState>> writers_;
  std::vector<std::shared_ptr<InMemoryReaderState>> readers_;
};

namespace {

class InMemoryWriter final : public Writer {
 public:
  InMemoryWriter(InMemoryBus& bus, const Guid& guid, std::shared_ptr<InMemoryWriterState> state)
      : bus_(bus),
        guid_(guid),
        topic_(bus.TopicNamed(state->options.topic)),
        state_(std::move(state)) {
    topic_.Add(state_);
  }
  ~InMemoryWriter() override { topic_.Remove(state_); }

  bool WaitForAcknowledgments(std::chrono::nanoseconds /*timeout*/) override { return true; }

  Result<void> Write(const void* message) override {
    const TypeSupport& type = state_->options.type;
    std::vector<std::uint8_t> payload(PayloadSize(type, message));
    payload.resize(ToPayload(type, message, payload));
    if (payload.empty()) {
      return Fail(ErrorCode::kMalformed, "a message of " + type.name + " cannot be serialised");
    }
    topic_.Write(*state_, std::make_shared<const InMemorySample>(
                              InMemorySample{std::move(payload), {bus_.source_time(), guid_}}));
    return {};
  }
  int matched() const override { return state_->matched; }
  int demanding() const override { return state_->matched - state_->sparse; }

 private:
  InMemoryBus& bus_;
  const Guid guid_;
  InMemoryTopic& topic_;
  std::shared_ptr<InMemoryWriterState> state_;
};

class InMemoryReader final : public Reader {
 public:
  InMemoryReader(InMemoryTopic& topic, std::shared_ptr<InMemoryReaderState> state)
      : topic_(topic), state_(std::move(state)) {
    topic_.Add(state_);
  }
  ~InMemoryReader() override { topic_.Remove(state_); }

  int matched() const override { return state_->matched; }
  std::uint64_t malformed() const override { return state_->malformed(); }
  Guid client_id() const override {
    Guid id{};
    const auto address = reinterpret_cast<std::uintptr_t>(this);
    std::memcpy(id.data(), &address, sizeof address);
    return id;
  }

 private:
  InMemoryTopic& topic_;
  std::shared_ptr<InMemoryReaderState> state_;
};

class InMemoryBackend final : public Backend {
 public:
  explicit InMemoryBackend(std::shared_ptr<InMemoryBus> bus)
      : bus_(std::move(bus)),
        over_link_(bus_->over_link()),
        guid_(bus_->NewGuid()),
        events_(std::make_shared<EventLog>()) {}

  std::unique_ptr<Writer> CreateWriter(const EndpointOptions& options) override {
    Guid guid = guid_;
    const std::uint32_t number = ++writers_;
    std::memcpy(guid.data() + kParticipantBytes, &number, sizeof number);
    return std::make_unique<InMemoryWriter>(
        *bus_, guid, std::make_shared<InMemoryWriterState>(options, events_));
  }
  std::unique_ptr<Reader> CreateReader(const EndpointOptions& options, Sink sink) override {
    EndpointOptions own = options;
    if (over_link_ && own.qos.demand == Demand::kSparseOverLinks) own.qos.demand = Demand::kSparse;
    return std::make_unique<InMemoryReader>(
        bus_->TopicNamed(options.topic),
        std::make_shared<InMemoryReaderState>(own, events_, std::move(sink)));
  }
  std::vector<Event> TakeEvents() override { return events_->Take(); }
  bool over_link() const override { return over_link_; }

 private:
  std::shared_ptr<InMemoryBus> bus_;
  const bool over_link_;
  const Guid guid_;
  std::atomic<std::uint32_t> writers_{0};
  std::shared_ptr<EventLog> events_;
};

}  // namespace

InMemoryBus::InMemoryBus() = default;
InMemoryBus::~InMemoryBus() = default;

InMemoryTopic& InMemoryBus::TopicNamed(const std::string& name) {
  const std::lock_guard lock(mutex_);
  auto& topic = topics_[name];
  if (!topic) topic = std::make_unique<InMemoryTopic>();
  return *topic;
}

Guid InMemoryBus::NewGuid() {
  Guid guid{};
  const std::uint64_t number = ++guids_;
  std::memcpy(guid.data(), &number, sizeof number);
  return guid;
}

std::unique_ptr<Backend> MakeInMemoryBackend(std::shared_ptr<InMemoryBus> bus) {
  return std::make_unique<InMemoryBackend>(std::move(bus));
}

}  // namespace conav::bus
