#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "bench/console/world.h"

namespace conav::bench {

/// The least that can follow the console's protocol: one WebSocket that takes every message, decodes
/// it and looks at the clock. What a page shows later than it has it, the browser takes.
///
/// Threads: one of its own.
class BareClient {
 public:
  /// Of the service on `port` of this machine. `frames`: robot whose live view it takes, as a page does.
  BareClient(int port, const Drive& drive, const std::string& frames);
  ~BareClient();
  BareClient(const BareClient&) = delete;
  BareClient& operator=(const BareClient&) = delete;

  /// In ms, of every state that came since the call before, from its sending until it was decoded.
  std::vector<double> TakeAges();
  double cpu_s() const { return cpu_s_; }
  bool ended() const { return ended_; }

 private:
  void Run(int port, const std::string& frames);

  const Drive drive_;
  std::atomic<double> cpu_s_ = 0.0;
  std::atomic<bool> stop_ = false;
  std::atomic<bool> ended_ = false;
  std::mutex mutex_;  // guards ages_ms_
  std::vector<double> ages_ms_;
  std::thread thread_;
};

}  // namespace conav::bench
