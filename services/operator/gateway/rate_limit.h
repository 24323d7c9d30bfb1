#pragma once

#include <algorithm>
#include <chrono>

#include "common/runtime/clock.h"

namespace conav::operators {

/// So many per second on average, and so many at once (a token bucket).
class RateLimit {
 public:
  RateLimit(double per_second, int burst, Clock::TimePoint now)
      : per_second_(per_second), burst_(burst), left_(burst), at_(now) {}

  /// False when one more is too much.
  bool Allow(Clock::TimePoint now) {
    const double passed = std::chrono::duration<double>(now - at_).count();
    at_ = now;
    left_ = std::min(static_cast<double>(burst_), left_ + passed * per_second_);
    if (left_ < 1.0) return false;
    left_ -= 1.0;
    return true;
  }
  /// The one that was allowed last shall not count.
  void GiveBack() { left_ = std::min(static_cast<double>(burst_), left_ + 1.0); }

 private:
  double per_second_;
  int burst_;
  double left_;
  Clock::TimePoint at_;
};

}  // namespace conav::operators
