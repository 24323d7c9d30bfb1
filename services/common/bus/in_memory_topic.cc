#include "common/bus/in_memory_topic.h"

#include <algorithm>

namespace conav::bus {
namespace {

enum class Matching { kNone, kMatched };

/// Matches as DDS does: by type name, then offered against requested QoS. A refusal for QoS is an
/// event on both sides, a refusal for the type is silent.
Matching Match(const InMemoryEndpoint& writer, const InMemoryEndpoint& reader) {
  if (writer.options.type.name != reader.options.type.name) return Matching::kNone;
  const Qos& offered = writer.options.qos;
  const Qos& requested = reader.options.qos;
  const char* policy = nullptr;
  if (offered.durability < requested.durability) policy = "durability";
  if (offered.reliability < requested.reliability) policy = "reliability";
  if (policy == nullptr) return Matching::kMatched;
  for (const auto* side : {&writer, &reader}) {
    side->events->Add({Event::Kind::kIncompatibleQos, side->options.topic, policy});
  }
  return Matching::kNone;
}

void Count(InMemoryEndpoint& endpoint, int change) {
  endpoint.matched += change;
  const auto kind = change > 0 ? Event::Kind::kMatched : Event::Kind::kUnmatched;
  endpoint.events->Add({kind, endpoint.options.topic, {}});
}

void Connect(InMemoryWriterState& writer, InMemoryReaderState& reader) {
  Count(writer, 1);
  Count(reader, 1);
  if (reader.options.qos.durability == Durability::kVolatile) return;
  for (const InMemoryPayload& payload : writer.history) reader.Enqueue(payload);
}

bool Compatible(const InMemoryEndpoint& writer, const InMemoryEndpoint& reader) {
  return writer.options.type.name == reader.options.type.name &&
         writer.options.qos.durability >= reader.options.qos.durability &&
         writer.options.qos.reliability >= reader.options.qos.reliability;
}

}  // namespace

void InMemoryReaderState::Enqueue(InMemoryPayload payload) {
  const std::lock_guard lock(mutex_);
  if (!closed_) queue_.push_back(std::move(payload));
}

void InMemoryReaderState::Drain() {
  std::unique_lock lock(mutex_);
  if (delivering_) return;
  delivering_ = true;
  while (!queue_.empty()) {
    const InMemoryPayload payload = std::move(queue_.front());
    queue_.pop_front();
    lock.unlock();
    intake_.Deliver(payload->bytes, payload->source);
    lock.lock();
  }
  delivering_ = false;
  idle_.notify_all();
}

void InMemoryReaderState::Close() {
  std::unique_lock lock(mutex_);
  closed_ = true;
  queue_.clear();
  idle_.wait(lock, [this] { return !delivering_; });
}

void InMemoryTopic::Add(const std::shared_ptr<InMemoryWriterState>& writer) {
  const std::lock_guard lock(mutex_);
  writers_.push_back(writer);
  for (const auto& reader : readers_) {
    if (Match(*writer, *reader) == Matching::kMatched) Connect(*writer, *reader);
  }
}

void InMemoryTopic::Add(const std::shared_ptr<InMemoryReaderState>& reader) {
  {
    const std::lock_guard lock(mutex_);
    readers_.push_back(reader);
    for (const auto& writer : writers_) {
      if (Match(*writer, *reader) == Matching::kMatched) Connect(*writer, *reader);
    }
  }
  reader->Drain();
}

void InMemoryTopic::Remove(const std::shared_ptr<InMemoryWriterState>& writer) {
  const std::lock_guard lock(mutex_);
  std::erase(writers_, writer);
  for (const auto& reader : readers_) {
    if (Compatible(*writer, *reader)) Count(*reader, -1);
  }
}

void InMemoryTopic::Remove(const std::shared_ptr<InMemoryReaderState>& reader) {
  {
    const std::lock_guard lock(mutex_);
    std::erase(readers_, reader);
    for (const auto& writer : writers_) {
      if (Compatible(*writer, *reader)) Count(*writer, -1);
    }
  }
  reader->Close();
}

void InMemoryTopic::Write(InMemoryWriterState& writer, InMemoryPayload payload) {
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

}  // namespace conav::bus
