#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/publisher.h"
#include "common/runtime/clock.h"

namespace conav {

/// How a service is, in the words of diagnostic_msgs (REP-107).
struct Health {
  enum class Level : std::uint8_t { kOk, kWarning, kError };
  Level level = Level::kOk;
  std::string message;
  std::vector<std::pair<std::string, std::string>> values;
};

/// Publishes a service's health on /diagnostics once per second of wall time.
class Diagnostics {
 public:
  Diagnostics(bus::Participant& participant, const Clock& clock)
      : name_(participant.node_name()), clock_(clock), publisher_(participant, bus::kDiagnostics) {}

  /// Call often, from one thread: asks for the health and publishes it when a second has passed.
  void Tick(const std::function<Health()>& health);

 private:
  std::string name_;
  const Clock& clock_;
  bus::Publisher<diagnostic_msgs::msg::DiagnosticArray> publisher_;
  Clock::TimePoint next_{};
};

}  // namespace conav
