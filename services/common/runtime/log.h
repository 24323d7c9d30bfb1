#pragma once

#include <fmt/format.h>

#include <chrono>
#include <functional>
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

/// Where each line goes besides stderr; empty = nowhere. Returns when no thread is inside the
/// former sink any more. A sink is called by one thread at a time, and must neither block nor log.
void SetSink(std::function<void(const Record&)> sink);

/// kStderr is for what a sink's own sending may cause: such a line must not feed itself.
enum class Reach { kStderrAndSink, kStderr };

/// One line on stderr: wall time, level, service, event, key=value... Threads: safe to call
/// concurrently, also after main has returned.
void Write(Level level, std::string_view event, std::string_view fields,
           Reach reach = Reach::kStderrAndSink);

inline void AppendFields(std::string&) {}

template <class Value, class... Rest>
void AppendFields(std::string& text, std::string_view key, const Value& value,
                  const Rest&... rest) {
  fmt::format_to(std::back_inserter(text), " {}={}", key, value);
  AppendFields(text, rest...);
}

template <class... Fields>
void Event(Reach reach, Level level, std::string_view event, const Fields&... fields) {
  static_assert(sizeof...(fields) % 2 == 0, "fields come as key, value, key, value");
  std::string text;
  AppendFields(text, fields...);
  Write(level, event, text, reach);
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
