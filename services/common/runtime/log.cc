#include "common/runtime/log.h"

#include <fmt/chrono.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <ctime>

namespace conav::log {
namespace {

std::string& ServiceName() {
  static std::string name = "conav";
  return name;
}

std::atomic<Level>& MinimumLevel() {
  static std::atomic<Level> level = Level::kInfo;
  return level;
}

std::string_view LevelName(Level level) {
  switch (level) {
    case Level::kDebug:
      return "DEBUG";
    case Level::kInfo:
      return "INFO";
    case Level::kWarning:
      return "WARN";
    case Level::kError:
      return "ERROR";
  }
  return "?";
}

}  // namespace

void SetService(std::string service) { ServiceName() = std::move(service); }
void SetMinimumLevel(Level level) { MinimumLevel() = level; }

void Write(Level level, std::string_view event, std::string_view fields) {
  if (level < MinimumLevel()) return;
  const auto now = std::chrono::system_clock::now();
  const auto milliseconds =
      std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch()).count() % 1000;
  std::tm utc{};
  const std::time_t seconds = std::chrono::system_clock::to_time_t(now);
  gmtime_r(&seconds, &utc);
  const std::string line =
      fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z {} {} {}{}\n", utc, milliseconds, LevelName(level),
                  ServiceName(), event, fields);
  // One write per line keeps lines of several threads and processes whole.
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, line.data(), line.size());
}

}  // namespace conav::log
