#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <limits>
#include <optional>

namespace conav {

/// Keeps a line that a loop or a peer may cause again and again to one per period:
///
///   if (const auto held_back = limit_.Allow()) LOG_WARNING("refused", "held_back", *held_back);
///
/// Threads: safe to call concurrently; of several at once one is allowed. Trivially destructible.
class LogLimit {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  explicit constexpr LogLimit(std::chrono::nanoseconds period = std::chrono::seconds(1))
      : period_(period) {}

  /// When a line may be written now: how many were held back since the last one.
  std::optional<std::uint64_t> Allow(TimePoint now = std::chrono::steady_clock::now()) {
    const std::int64_t now_ns = std::chrono::nanoseconds(now.time_since_epoch()).count();
    std::int64_t next = next_ns_.load();
    if (now_ns >= next && next_ns_.compare_exchange_strong(next, now_ns + period_.count())) {
      return held_back_.exchange(0);
    }
    ++held_back_;
    return std::nullopt;
  }

 private:
  const std::chrono::nanoseconds period_;
  std::atomic<std::int64_t> next_ns_{std::numeric_limits<std::int64_t>::min()};
  std::atomic<std::uint64_t> held_back_{0};
};

}  // namespace conav
