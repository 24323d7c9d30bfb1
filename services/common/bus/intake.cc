#include "common/bus/intake.h"

#include <exception>

#include "common/runtime/log.h"

namespace conav::bus {

void Intake::Deliver(std::span<const std::uint8_t> payload, SourceTime source) noexcept {
  try {
    void* message = Acquire();
    if (endpoint_.type.deserialize(payload, message)) {
      Accept(message, source);
    } else {
      Refuse(message);
    }
  } catch (const std::exception& error) {
    LOG_ERROR("message lost", "topic", endpoint_.topic, "reason", error.what());
  }
}

void* Intake::Acquire() {
  void* message = spare_.exchange(nullptr, std::memory_order_acquire);
  return message != nullptr ? message : endpoint_.type.create();
}

void Intake::Accept(void* message, SourceTime source) noexcept {
  try {
    sink_(message, source);
  } catch (const std::exception& error) {
    LOG_ERROR("a handler threw", "topic", endpoint_.topic, "reason", error.what());
  }
  Release(message);
}

void Intake::Refuse(void* message) noexcept {
  Release(message);
  events_.Malformed(endpoint_, ++malformed_);
}

void Intake::Release(void* message) noexcept {
  message = spare_.exchange(message, std::memory_order_acq_rel);
  if (message != nullptr) endpoint_.type.destroy(message);
}

}  // namespace conav::bus
