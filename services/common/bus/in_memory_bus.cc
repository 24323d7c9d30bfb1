#include "common/bus/in_memory_bus.h"

#include "common/bus/in_memory_topic.h"

namespace conav::bus {
namespace {

class InMemoryWriter final : public Writer {
 public:
  InMemoryWriter(InMemoryBus& bus, std::shared_ptr<InMemoryWriterState> state)
      : bus_(bus), topic_(bus.TopicNamed(state->options.topic)), state_(std::move(state)) {
    topic_.Add(state_);
  }
  ~InMemoryWriter() override { topic_.Remove(state_); }

  bool WaitForAcknowledgments(std::chrono::nanoseconds /*timeout*/) override { return true; }

  Result<void> Write(const void* message) override {
    const TypeSupport& type = state_->options.type;
    std::vector<std::uint8_t> payload(type.serialized_size(message));
    payload.resize(type.serialize(message, payload));
    if (payload.empty()) {
      return Fail(ErrorCode::kMalformed, "a message of " + type.name + " cannot be serialised");
    }
    topic_.Write(*state_, std::make_shared<const InMemorySample>(
                              InMemorySample{std::move(payload), bus_.source_time()}));
    return {};
  }
  int matched() const override { return state_->matched; }

 private:
  InMemoryBus& bus_;
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

 private:
  InMemoryTopic& topic_;
  std::shared_ptr<InMemoryReaderState> state_;
};

class InMemoryBackend final : public Backend {
 public:
  explicit InMemoryBackend(std::shared_ptr<InMemoryBus> bus)
      : bus_(std::move(bus)), events_(std::make_shared<EventLog>()) {}

  std::unique_ptr<Writer> CreateWriter(const EndpointOptions& options) override {
    return std::make_unique<InMemoryWriter>(
        *bus_, std::make_shared<InMemoryWriterState>(options, events_));
  }
  std::unique_ptr<Reader> CreateReader(const EndpointOptions& options, Sink sink) override {
    return std::make_unique<InMemoryReader>(
        bus_->TopicNamed(options.topic),
        std::make_shared<InMemoryReaderState>(options, events_, std::move(sink)));
  }
  std::vector<Event> TakeEvents() override { return events_->Take(); }

 private:
  std::shared_ptr<InMemoryBus> bus_;
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

std::unique_ptr<Backend> MakeInMemoryBackend(std::shared_ptr<InMemoryBus> bus) {
  return std::make_unique<InMemoryBackend>(std::move(bus));
}

}  // namespace conav::bus
