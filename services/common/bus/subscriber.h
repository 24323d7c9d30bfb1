#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/backend.h"
#include "common/bus/participant.h"
#include "common/bus/topics.h"
#include "common/bus/type_support.h"
#include "common/runtime/log.h"
#include "common/runtime/result.h"

namespace conav::bus {

/// A message, its publication time by the clock of the publisher's host, and its writer. Both hosts' wall clocks
/// must agree as closely as the times are compared. For a late joiner that time is long before the
/// arrival.
template <class T>
struct Stamped {
  T value;
  SourceTime source;
  Guid writer{};
};

/// Receives messages of type T from one topic. Constructing connects, destroying disconnects.
///
/// Either the owner takes messages from a queue (bounded by the topic's depth, oldest dropped
/// first), or a handler gets each message at once, on the bus's receive thread. A handler must be
/// short and must not throw. It may publish, but not on its own topic, and it must not retry when
/// the queue is full: the acknowledgements that would empty the queue may need the handler's
/// thread.
///
/// A payload that is not a T is dropped and counted with a warning. Each sample arrives once, also
/// when a link was cut and the vendor repeats its history. Volatile topics guarantee nothing until
/// about 0.1 s after both sides have discovered each other: a client that needs an answer asks
/// again.
template <class T>
class Subscriber {
 public:
  using Handler = std::function<void(T&&)>;
  using HandlerWithOrigin = std::function<void(T&&, const Origin&)>;

  /// Without `notifier`, new messages end the Wait() of the participant.
  Subscriber(Participant& participant, const Topic<T>& topic, std::string_view entity = {},
             Handler handler = nullptr, Notifier* notifier = nullptr);
  /// The handler learns who sent a message.
  Subscriber(Participant& participant, const Topic<T>& topic, std::string_view entity,
             HandlerWithOrigin handler, Notifier* notifier = nullptr);

  /// Everything since the last call, oldest first; may be empty.
  std::vector<T> Take();
  std::vector<Stamped<T>> TakeStamped();

  /// Take(), with each message moved through `convert` (a T&& -> Result<D>). Rejected messages are
  /// left out, counted, and logged with topic, field and value, at most once a second.
  template <class Convert>
  auto TakeValid(Convert&& convert);
  /// As TakeValid, each as Stamped<D>.
  template <class Convert>
  auto TakeValidStamped(Convert&& convert);

  int matched_publishers() const { return reader_->matched(); }
  Guid client_id() const { return reader_->client_id(); }
  /// Payloads that could not be decoded, plus messages that `convert` rejected.
  std::uint64_t malformed() const { return reader_->malformed(); }
  std::uint64_t refused() const { return refused_; }

 private:
  void Receive(T&& message, const Origin& origin);
  void NoteRefused(const Error& error);

  std::string topic_;
  HandlerWithOrigin handler_;
  Notifier* notifier_;
  std::size_t capacity_;
  std::mutex mutex_;  // guards queue_
  std::deque<Stamped<T>> queue_;
  std::uint64_t refused_ = 0;
  LogLimit refusals_logged_;
  std::unique_ptr<Reader> reader_;  // last: no delivery before the rest exists
};

template <class T>
Subscriber<T>::Subscriber(Participant& participant, const Topic<T>& topic, std::string_view entity,
                          Handler handler, Notifier* notifier)
    : Subscriber(
          participant, topic, entity,
          handler ? HandlerWithOrigin([handler = std::move(handler)](T&& message, const Origin&) {
            handler(std::move(message));
          })
                  : HandlerWithOrigin(),
          notifier) {}

template <class T>
Subscriber<T>::Subscriber(Participant& participant, const Topic<T>& topic, std::string_view entity,
                          HandlerWithOrigin handler, Notifier* notifier)
    : topic_(topic.NameFor(entity)),
      handler_(std::move(handler)),
      notifier_(notifier != nullptr ? notifier : &participant.notifier()),
      capacity_(static_cast<std::size_t>(topic.qos.depth > 0 ? topic.qos.depth : kKeepAllLimit)) {
  reader_ = participant.backend().CreateReader(
      {topic_, TypeSupportOf<T>(), topic.qos}, [this](void* message, const Origin& origin) {
        Receive(std::move(*static_cast<T*>(message)), origin);
      });
}

template <class T>
void Subscriber<T>::Receive(T&& message, const Origin& origin) {
  if (handler_) {
    handler_(std::move(message), origin);
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    if (queue_.size() >= capacity_) queue_.pop_front();
    queue_.push_back({std::move(message), origin.time, origin.writer});
  }
  notifier_->Notify();
}

template <class T>
std::vector<Stamped<T>> Subscriber<T>::TakeStamped() {
  std::deque<Stamped<T>> taken;
  {
    const std::lock_guard lock(mutex_);
    taken.swap(queue_);
  }
  return {std::make_move_iterator(taken.begin()), std::make_move_iterator(taken.end())};
}

template <class T>
std::vector<T> Subscriber<T>::Take() {
  std::vector<T> messages;
  for (Stamped<T>& taken : TakeStamped()) messages.push_back(std::move(taken.value));
  return messages;
}

template <class T>
void Subscriber<T>::NoteRefused(const Error& error) {
  ++refused_;
  if (!refusals_logged_.Allow()) return;
  LOG_WARNING("message refused", "topic", topic_, "reason", error.text, "count", refused_);
}

template <class T>
template <class Convert>
auto Subscriber<T>::TakeValidStamped(Convert&& convert) {
  using Domain = typename std::invoke_result_t<Convert, T>::value_type;
  std::vector<Stamped<Domain>> valid;
  for (Stamped<T>& taken : TakeStamped()) {
    Result<Domain> result = convert(std::move(taken.value));
    if (result) {
      valid.push_back({*std::move(result), taken.source, taken.writer});
    } else {
      NoteRefused(result.error());
    }
  }
  return valid;
}

template <class T>
template <class Convert>
auto Subscriber<T>::TakeValid(Convert&& convert) {
  using Domain = typename std::invoke_result_t<Convert, T>::value_type;
  std::vector<Domain> valid;
  for (auto& taken : TakeValidStamped(std::forward<Convert>(convert))) {
    valid.push_back(std::move(taken.value));
  }
  return valid;
}

}  // namespace conav::bus
