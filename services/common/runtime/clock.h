#pragma once

#include <chrono>
#include <cstdint>

namespace conav {

/// Simulation time: what `/clock` carries. A type of its own, never mixed with wall time.
struct SimTime {
  std::int64_t nanoseconds = 0;

  static SimTime FromSeconds(double seconds);
  double ToSeconds() const { return static_cast<double>(nanoseconds) * 1e-9; }
  auto operator<=>(const SimTime&) const = default;
};

inline SimTime operator+(SimTime time, std::chrono::nanoseconds duration) {
  return {time.nanoseconds + duration.count()};
}

/// Wall time from a setting in seconds.
inline std::chrono::nanoseconds Seconds(double seconds) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
      std::chrono::duration<double>(seconds));
}

/// Monotonic wall time for deadlines and durations. Injected, so that a test can control it.
class Clock {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  virtual ~Clock() = default;
  virtual TimePoint Now() const = 0;
};

class SteadyClock final : public Clock {
 public:
  TimePoint Now() const override { return std::chrono::steady_clock::now(); }
};

class FakeClock final : public Clock {
 public:
  TimePoint Now() const override { return now_; }
  void Advance(std::chrono::nanoseconds duration) { now_ += duration; }

 private:
  TimePoint now_{};
};

/// Wall time of the console's pages: s since 1970.
inline double ToWallSeconds(std::chrono::system_clock::time_point time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}
inline double WallSeconds() { return ToWallSeconds(std::chrono::system_clock::now()); }

}  // namespace conav
