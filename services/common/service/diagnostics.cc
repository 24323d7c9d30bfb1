#include "common/service/diagnostics.h"

#include <fmt/core.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include "common/bus/ros_graph.h"
#include "common/runtime/log.h"
#include "common/runtime/text.h"

namespace conav {
namespace {

constexpr const char* kStarted = "started";
constexpr const char* kClockAnswer = "clock";  // "<asked ns> <received ns> <host>"

}  // namespace

void NotifySystemd(std::string_view state) {
  const char* path = std::getenv("NOTIFY_SOCKET");
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path == nullptr || std::strlen(path) >= sizeof address.sun_path) return;
  std::strcpy(address.sun_path, path);
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + std::strlen(path));
  if (address.sun_path[0] == '@') address.sun_path[0] = '\0';  // an abstract socket
  const int descriptor = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return;
  sendto(descriptor, state.data(), state.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
         reinterpret_cast<const sockaddr*>(&address), size);
  close(descriptor);
}

Diagnostics::Diagnostics(bus::Participant& participant, const Clock& clock, TimeOfDay time_of_day)
    : name_(participant.node_name()),
      started_(std::to_string(std::chrono::system_clock::now().time_since_epoch().count())),
      clock_(clock),
      time_of_day_(std::move(time_of_day)),
      publisher_(participant, bus::kDiagnostics),
      probes_(participant, bus::kClockProbe, {}, [this](rosgraph_msgs::msg::Clock&& probe) {
        const std::chrono::nanoseconds received = time_of_day_().time_since_epoch();
        const std::lock_guard lock(mutex_);
        clock_answer_ = fmt::format("{} {} {}", ToDuration(probe.clock()).count(), received.count(),
                                    bus::HostName());
      }) {}

std::string Diagnostics::TakeClockAnswer() {
  const std::lock_guard lock(mutex_);
  return std::exchange(clock_answer_, {});
}

void Diagnostics::Tick(const std::function<Health()>& health) {
  const Clock::TimePoint now = clock_.Now();
  if (now < next_) return;
  const bool is_sparse = publisher_.demanding_subscribers() == 0;
  const bool has_values = !is_sparse || now >= values_due_;
  if (has_values) values_due_ = now + kValuesPeriod;
  next_ = now + (is_sparse ? kSparsePeriod : kPeriod);
  NotifySystemd("WATCHDOG=1");
  Health state = health();
  if (!has_values) state.values.clear();
  state.values.emplace_back(kStarted, started_);
  if (std::string answer = TakeClockAnswer(); !answer.empty()) {
    state.values.emplace_back(kClockAnswer, std::move(answer));
  }
  diagnostic_msgs::msg::DiagnosticStatus status;
  status.level(static_cast<std::uint8_t>(state.level));
  status.name(name_ + ": health");
  status.message(state.message);
  status.hardware_id(name_);
  for (const auto& [key, value] : state.values) {
    diagnostic_msgs::msg::KeyValue pair;
    pair.key(key);
    pair.value(value);
    status.values().push_back(std::move(pair));
  }
  diagnostic_msgs::msg::DiagnosticArray array;
  array.header().stamp(RosWallTime(time_of_day_()));
  array.status().push_back(std::move(status));
  if (const auto sent = publisher_.Publish(array); !sent) {
    LOG_WARNING("diagnostics not sent", "reason", sent.error().text);
  }
}

namespace {

// Bytes; longer ones are cut off.
constexpr std::size_t kLongestName = 100;
constexpr std::size_t kLongestMessage = 500;

/// Nothing where the status has none, or one that cannot be read.
std::optional<ClockAnswer> ClockAnswerOf(const diagnostic_msgs::msg::DiagnosticStatus& status,
                                         const builtin_interfaces::msg::Time& sent) {
  for (const auto& pair : status.values()) {
    if (pair.key() != kClockAnswer) continue;
    std::int64_t asked = 0;
    std::int64_t received = 0;
    std::string host;
    if (!(std::istringstream(pair.value()) >> asked >> received >> host)) continue;
    const std::chrono::duration<double> received_s = std::chrono::nanoseconds(received);
    const std::chrono::duration<double> sent_s = ToDuration(sent);
    return ClockAnswer{std::chrono::nanoseconds(asked), received_s.count(), sent_s.count(),
                       Readable(host.substr(0, kLongestName))};
  }
  return std::nullopt;
}

std::string StartedOf(const diagnostic_msgs::msg::DiagnosticStatus& status) {
  const auto started = std::ranges::find(
      status.values(), kStarted, [](const auto& pair) { return std::string_view(pair.key()); });
  return started == status.values().end() ? "" : Readable(started->value());
}

}  // namespace

bool HasValues(const diagnostic_msgs::msg::DiagnosticStatus& status) {
  return std::ranges::any_of(status.values(), [](const auto& pair) {
    return pair.key() != kStarted && pair.key() != kClockAnswer;
  });
}

std::vector<ReportedHealth> HealthOf(const diagnostic_msgs::msg::DiagnosticArray& message) {
  std::vector<ReportedHealth> all;
  for (const auto& status : message.status()) {
    if (status.hardware_id().empty()) continue;  // not a conav process
    const auto level = std::min<int>(status.level(), static_cast<int>(Health::Level::kError));
    all.push_back({Readable(status.hardware_id().substr(0, kLongestName)),
                   static_cast<Health::Level>(level),
                   Readable(status.message().substr(0, kLongestMessage)), StartedOf(status),
                   ClockAnswerOf(status, message.header().stamp())});
  }
  return all;
}

}  // namespace conav
