#pragma once

#include <fmt/core.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace conav::log {

enum class Level { kDebug, kInfo, kWarning, kError };

/// Names the process in every line ("planner", "sim"). Call once, before threads start.
void SetService(std::string service);
void SetMinimumLevel(Level level);

struct Record {
  std::chrono::system_clock::time_point time;
  Level level;
  std::string_view text;  // event and fields; valid during the call
};

/// Sets where lines go in addition to stderr; empty = nowhere. When it returns, no thread is inside
/// the former sink. One thread at a time calls a sink; a sink must neither block nor log.
void SetSink(std::function<void(const Record&)> sink);

/// kStderr is for lines that a sink's own sending may cause: they must not feed back.
enum class Reach { kStderrAndSink, kStderr };

/// One line on stderr: wall time, level, service, event, key=value... Threads: safe to call
/// concurrently, also after main has returned.
void Write(Level level, std::string_view event, std::string_view fields,
           Reach reach = Reach::kStderrAndSink);

/// " key=value" for each two of `fields`.
std::string FieldsText(fmt::format_args fields, std::size_t count);

template <class... Fields>
void Event(Reach reach, Level level, std::string_view event, const Fields&... fields) {
  static_assert(sizeof...(fields) % 2 == 0, "fields come as key, value, key, value");
  Write(level, event, FieldsText(fmt::make_format_args(fields...), sizeof...(fields) / 2), reach);
}

template <class... Fields>
void Event(Level level, std::string_view event, const Fields&... fields) {
  Event(Reach::kStderrAndSink, level, event, fields...);
}

}  // namespace conav::log

/// LOG_INFO("planned", "robot", name, "iterations", count): event first, then key, value pairs.
#define LOG_DEBUG(...) ::conav::log::Event(::conav::log::Level::kDebug, __VA_ARGS__)
#define LOG_INFO(...) ::conav::log::Event(::conav::log::Level::kInfo, __VA_ARGS__)
#define LOG_WARNING(...) ::conav::log::Event(::conav::log::Level::kWarning, __VA_ARGS__)
#define LOG_ERROR(...) ::conav::log::Event(::conav::log::Level::kError, __VA_ARGS__)

namespace conav {

/// Limits a repeated line of a loop or peer to one per period:
///
///   if (const auto held_back = limit_.Allow()) LOG_WARNING("refused", "held_back", *held_back);
///
/// Threads: safe to call concurrently; one of several concurrent calls is allowed. Trivially
///          destructible.
class LogLimit {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  explicit constexpr LogLimit(std::chrono::nanoseconds period = std::chrono::seconds(1))
      : period_(period) {}

  /// If a line may be written now, the number of lines held back since the last one.
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
