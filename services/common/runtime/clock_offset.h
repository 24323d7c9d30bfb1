#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>

namespace conav {

/// A clock that is off by more than this is named.
inline constexpr double kClockLimitS = 0.25;

/// How far another host's clock is ahead of ours, from questions that it answered: as NTP does, by the
/// midpoint of the quickest, whose error is at most half of its round trip.
///
/// Answers that contradict the newest one are dropped: a clock was set meanwhile. Times in s, each
/// clock from a zero of its own. Pure; threads: not synchronised.
class ClockOffset {
 public:
  struct Sample {
    double offset_s = 0.0;  // the other's time minus ours
    double round_trip_s = 0.0;
  };

  /// Answers that are kept.
  static constexpr std::size_t kWindow = 16;
  /// Two clocks may drift apart by so much over the window.
  static constexpr double kDriftS = 0.005;

  /// `asked_s`, `arrived_s`: by our clock; `received_s`, `sent_s`: when the other received the question and
  /// answered it, by its own. False for an answer that no clocks allow, which does not count.
  bool Add(double asked_s, double received_s, double sent_s, double arrived_s) {
    const double round_trip_s = (arrived_s - asked_s) - (sent_s - received_s);
    const Sample sample{((received_s - asked_s) + (sent_s - arrived_s)) / 2.0,
                        std::max(round_trip_s, 0.0)};
    const bool is_possible =
        std::isfinite(round_trip_s) && sent_s >= received_s && round_trip_s > -kDriftS;
    if (!is_possible) return false;
    std::erase_if(samples_, [&](const Sample& other) { return !Agree(sample, other); });
    if (samples_.size() >= kWindow) samples_.pop_front();
    samples_.push_back(sample);
    return true;
  }

  /// The quickest; nothing before the first answer.
  std::optional<Sample> best() const {
    if (samples_.empty()) return std::nullopt;
    return *std::ranges::min_element(samples_, {}, &Sample::round_trip_s);
  }

 private:
  static bool Agree(const Sample& one, const Sample& other) {
    return std::abs(one.offset_s - other.offset_s) <=
           (one.round_trip_s + other.round_trip_s) / 2.0 + kDriftS;
  }

  std::deque<Sample> samples_;
};

}  // namespace conav
