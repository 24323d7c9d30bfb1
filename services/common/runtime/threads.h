#pragma once

#include <atomic>
#include <functional>

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

/// Calls task(worker, index) once for each index in [0, count), on `threads` threads at most (the
/// caller's is one of them), and returns when all are done. worker is in [0, threads) and never at
/// work on two indices at once; which worker takes which index is up to the machine.
/// A task must not throw: on another thread than the caller's that ends the process.
void RunOnWorkers(int threads, int count, const std::function<void(int worker, int index)>& task);

}  // namespace conav
