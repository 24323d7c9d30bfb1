#include "common/runtime/log.h"

#include <fmt/core.h>
#include <unistd.h>

#include <array>
#include <mutex>

#include "common/runtime/text.h"

namespace conav::log {
namespace {

/// The state of the process-wide log.
struct State {
  std::string service = "conav";
  std::atomic<Level> minimum_level = Level::kInfo;
  std::mutex mutex;  // guards sink
  std::function<void(const Record&)> sink;
};

/// Never destroyed: threads of the DDS vendors may log after main has returned.
State& TheState() {
  static State& state = *new State;
  return state;
}

// In the order of Level.
constexpr std::array kLevelNames{"DEBUG", "INFO", "WARN", "ERROR"};

}  // namespace

void SetService(std::string service) { TheState().service = std::move(service); }
void SetMinimumLevel(Level level) { TheState().minimum_level = level; }

void SetSink(std::function<void(const Record&)> sink) {
  State& state = TheState();
  const std::lock_guard lock(state.mutex);
  state.sink = std::move(sink);
}

std::string FieldsText(fmt::format_args fields, std::size_t count) {
  std::string format;
  for (std::size_t i = 0; i < count; ++i) format += " {}={}";
  return fmt::vformat(format, fields);
}

void Write(Level level, std::string_view event, std::string_view fields, Reach reach) {
  State& state = TheState();
  if (level < state.minimum_level) return;
  const auto now = std::chrono::system_clock::now();
  const auto milliseconds =
      std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch()).count() % 1000;
  const std::string text = fmt::format("{}{}", event, fields);
  const std::string line = fmt::format(
      "{}.{:03}Z {} {} {}\n",
      UtcTime(std::chrono::system_clock::to_time_t(now), "%Y-%m-%dT%H:%M:%S"), milliseconds,
      kLevelNames.at(static_cast<std::size_t>(level)), state.service, text);
  // One write per line keeps lines of several threads and processes whole.
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, line.data(), line.size());
  if (reach == Reach::kStderr) return;
  const std::lock_guard lock(state.mutex);
  if (state.sink) state.sink({now, level, text});
}

}  // namespace conav::log
