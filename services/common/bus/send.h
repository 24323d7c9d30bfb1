#pragma once

#include "common/bus/publisher.h"
#include "common/runtime/log.h"

namespace conav::bus {

/// Publishes, and logs a failure with the topic's type: for messages whose loss the sender cannot
/// mend.
template <class T>
void Send(Publisher<T>& publisher, const T& message) {
  if (const auto sent = publisher.Publish(message); !sent) {
    LOG_ERROR("message not sent", "type", TypeSupportOf<T>().name, "reason", sent.error().text);
  }
}

}  // namespace conav::bus
