#include "common/bus/intake.h"

#include <algorithm>
#include <exception>

#include "common/runtime/log.h"

namespace conav::bus {

bool Deduplicator::IsNew(const Guid& writer, std::int64_t stamp) {
  Window& window = WindowOf(writer);
  if (std::find(window.stamps.begin(), window.stamps.end(), stamp) != window.stamps.end()) {
    return false;
  }
  if (window.stamps.size() < window_) {
    window.stamps.push_back(stamp);
  } else {
    window.stamps[window.oldest] = stamp;
    window.oldest = (window.oldest + 1) % window_;
  }
  return true;
}

std::size_t Deduplicator::bytes() const {
  std::size_t bytes = 0;
  for (const Window& window : windows_) bytes += window.stamps.capacity() * sizeof(std::int64_t);
  return bytes;
}

Deduplicator::Window& Deduplicator::WindowOf(const Guid& writer) {
  const auto of_writer = [&](const Window& window) { return window.writer == writer; };
  const auto found = std::find_if(windows_.rbegin(), windows_.rend(), of_writer);
  if (found != windows_.rend()) {
    std::rotate(found.base() - 1, found.base(), windows_.end());
    return windows_.back();
  }
  if (windows_.size() >= kWriters) windows_.erase(windows_.begin());
  windows_.push_back({writer, {}, 0});
  windows_.back().stamps.reserve(std::min(window_, kWindow / 4));
  return windows_.back();
}

void Intake::Deliver(std::span<const std::uint8_t> payload, const Origin& origin) noexcept {
  try {
    void* message = Acquire();
    if (FromPayload(endpoint_.type, payload, message)) {
      Accept(message, origin);
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

void Intake::Accept(void* message, const Origin& origin) noexcept {
  try {
    sink_(message, origin);
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
