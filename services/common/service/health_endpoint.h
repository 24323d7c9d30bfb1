#pragma once

#include <atomic>
#include <map>
#include <string>
#include <thread>

#include "common/bus/subscriber.h"
#include "common/runtime/clock.h"
#include "common/service/diagnostics.h"

// One user: service_main.h, for every service.

namespace conav {

/// Answers probes over HTTP, on a port of this machine or a Unix socket:
///
///   /livez    200 while the service's own thread reports (Diagnostics), or has not begun to; else 503
///   /readyz   JSON, its health and that of the processes that it receives reports of; 503: it has an
///             error, is silent, or has not begun
///   /metrics  for Prometheus: conav_health_level of each process, and the service's own numbers
///
/// One client at a time, at most half a second each. What it says is what the service publishes on
/// /diagnostics. Threads: one of its own.
class HealthEndpoint {
 public:
  static constexpr std::chrono::seconds kSilent{3};

  /// `address`: a port, or the path of a socket, which is replaced. Throws StartupError: it cannot
  /// listen there.
  HealthEndpoint(bus::Participant& participant, const Clock& clock, const std::string& address);
  ~HealthEndpoint();
  HealthEndpoint(const HealthEndpoint&) = delete;
  HealthEndpoint& operator=(const HealthEndpoint&) = delete;

 private:
  struct Heard {
    diagnostic_msgs::msg::DiagnosticStatus status;
    Clock::TimePoint at{};
  };

  void Run();
  void Serve(int client);
  void TakeReports();
  /// Of the newest report; above kSilent the process counts as silent.
  double AgeOf(const Heard& heard) const;
  /// "ok", "warning", "error" or "silent".
  std::string LevelOf(const Heard& heard) const;
  /// The whole response to a path.
  std::string Answer(const std::string& path) const;
  std::string Readiness(bool& ready) const;
  std::string Metrics() const;

  const std::string name_;
  const Clock& clock_;
  const std::string address_;
  bus::Subscriber<diagnostic_msgs::msg::DiagnosticArray> reports_;
  std::map<std::string, Heard> heard_;  // by process
  int listener_ = -1;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace conav
