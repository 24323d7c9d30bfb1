#include "operator/recorder/arrivals.h"

#include <chrono>
#include <utility>

namespace conav::recorder {

Arrivals::Arrivals(std::size_t limit_bytes, std::function<void()> wake, WallClock now)
    : limit_bytes_(limit_bytes), wake_(std::move(wake)), now_(std::move(now)) {}

void Arrivals::Add(std::uint16_t channel, std::optional<std::uint64_t> stamp, bag::Bytes data) {
  bool many = false;
  {
    const std::lock_guard lock(mutex_);
    if (waiting_bytes_ + data.size() > limit_bytes_) {
      ++dropped_;
      return;
    }
    waiting_bytes_ += data.size();
    many = waiting_bytes_ > limit_bytes_ / 4;
    const std::uint64_t now = now_();  // here, so that the order is that of the queue
    waiting_.push_back({channel, now, stamp.value_or(now), std::move(data)});
  }
  if (many) wake_();
}

std::vector<Arrival> Arrivals::Take() {
  const std::lock_guard lock(mutex_);
  waiting_bytes_ = 0;
  return std::exchange(waiting_, {});
}

std::uint64_t Arrivals::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

std::uint64_t Arrivals::SystemTime() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::nanoseconds(now).count());
}

}  // namespace conav::recorder
