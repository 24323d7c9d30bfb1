#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "common/bus/backend.h"
#include "common/bus/participant.h"
#include "common/bus/topics.h"
#include "common/bus/type_support.h"
#include "common/runtime/log.h"
#include "common/runtime/result.h"

namespace conav::bus {

/// Sends messages of type T on one topic. Constructing connects, destroying disconnects.
/// Threads: Publish is safe to call concurrently.
template <class T>
class Publisher {
 public:
  /// `entity` fills the "{}" of the topic's pattern: a robot or a world.
  Publisher(Participant& participant, const Topic<T>& topic, std::string_view entity = {})
      : writer_(participant.backend().CreateWriter(
            {topic.NameFor(entity), TypeSupportOf<T>(), topic.qos})) {}

  /// Errors: kUnavailable when the bus cannot take the message (queue full after retries, out of
  ///         resources), kMalformed when it cannot be serialised.
  [[nodiscard]] Result<void> Publish(const T& message) { return writer_->Write(&message); }

  /// For a process that is about to exit: blocks until every matched reliable subscriber has
  /// everything; false after `timeout`.
  bool WaitForAcknowledgments(std::chrono::nanoseconds timeout) {
    return writer_->WaitForAcknowledgments(timeout);
  }

  int matched_subscribers() const { return writer_->matched(); }
  /// Without those that are Demand::kSparse. A little late: a few milliseconds after the match.
  int demanding_subscribers() const { return writer_->demanding(); }

 private:
  std::unique_ptr<Writer> writer_;
};

/// Publishes, and logs a failure with the topic's type. For messages whose loss the sender cannot
/// repair.
template <class T>
void Send(Publisher<T>& publisher, const T& message) {
  if (const auto sent = publisher.Publish(message); !sent) {
    LOG_ERROR("message not sent", "type", TypeSupportOf<T>().name, "reason", sent.error().text);
  }
}

}  // namespace conav::bus
