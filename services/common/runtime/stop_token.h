#pragma once

#include <atomic>

namespace conav {

/// Asks a loop to end. Threads: any thread may ask, any may look.
class StopToken {
 public:
  void RequestStop() { stop_.store(true, std::memory_order_relaxed); }
  bool stop_requested() const { return stop_.load(std::memory_order_relaxed); }

 private:
  std::atomic<bool> stop_{false};
};

/// The token that SIGINT and SIGTERM set, after InstallStopSignals(). The handler only sets this
/// flag.
StopToken& ProcessStopToken();

/// Directs SIGINT and SIGTERM to ProcessStopToken(), and ignores SIGPIPE. Call once, in main.
void InstallStopSignals();

}  // namespace conav
