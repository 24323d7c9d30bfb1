#pragma once

#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "bench/bus/stack.h"

namespace conav::bench {

/// A child process whose standard input ends with this object; it is then waited for.
class PeerProcess {
 public:
  /// `program` is looked up in PATH. With `quiet` its output goes nowhere.
  PeerProcess(const std::string& program, const std::vector<std::string>& arguments, bool quiet);
  ~PeerProcess();
  PeerProcess(const PeerProcess&) = delete;
  PeerProcess& operator=(const PeerProcess&) = delete;

  /// SIGTERM.
  void Terminate();

 private:
  pid_t pid_ = -1;
  int input_ = -1;
};

struct RoundTrips {
  double p50_us = 0.0;
  double p99_us = 0.0;
};

/// One stack with its peer process, ready to be measured again and again.
class Traffic {
 public:
  /// Starts the peer and waits until both sides know of each other. Throws std::runtime_error.
  Traffic(const StackOptions& options, const std::string& own_program);
  ~Traffic();

  /// `count` round trips, one at a time, each started by the callback of the one before.
  /// Throws std::runtime_error when an answer is missing.
  RoundTrips MeasureRoundTrips(std::size_t size, std::uint64_t count);

  /// Messages per second over `count` messages sent without waiting, until the last has arrived.
  double MeasureRate(std::size_t size, std::uint64_t count);

 private:
  using TimePoint = std::chrono::steady_clock::time_point;

  void OnPong(std::uint64_t id);
  void Connect();
  bool WaitFor(std::uint64_t id, std::chrono::milliseconds timeout);

  const std::string name_;
  // Set before the first ping of a measurement, then changed by the receive thread alone; late
  // answers from before may look at the first two at any time.
  std::atomic<std::uint64_t> next_id_ = 1;
  std::atomic<std::uint64_t> last_id_ = 0;
  TimePoint sent_at_;
  std::vector<double> times_us_;

  std::mutex mutex_;  // guards answered_
  std::condition_variable answer_;
  std::uint64_t answered_ = 0;

  std::unique_ptr<PeerProcess> peer_;
  std::unique_ptr<Pinger> pinger_;  // last: calls OnPong
};

}  // namespace conav::bench
