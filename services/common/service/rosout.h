#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "common/bus/publisher.h"
#include "common/runtime/log.h"

namespace conav {

/// Publishes what the process logs on /rosout while it lives, so that `ros2 topic echo /rosout` and
/// rqt_console show it; levels and names as rclcpp sets them. One at a time per process.
///
/// A line may be logged on a DDS vendor's own thread, from which nothing must be sent: a thread of
/// this object's own sends it. When the bus does not take the lines as fast as they come, the
/// oldest are left out, and the next one that goes out says how many.
class Rosout {
 public:
  /// Most lines that wait to be sent.
  static constexpr std::size_t kQueueLimit = 1000;
  static constexpr std::chrono::seconds kDrainLimit{1};

  /// Sends one line; false when the bus did not take it.
  using Send = std::function<bool(const rcl_interfaces::msg::Log&)>;

  explicit Rosout(bus::Participant& participant);
  /// As above with any way of sending, under the name `node_name`.
  Rosout(std::string node_name, Send send);
  /// Sends what waits, but not to a bus that takes no more lines: ends with the first that fails,
  /// and with the first after kDrainLimit; then waits as long for the last ones to arrive.
  ~Rosout();
  Rosout(const Rosout&) = delete;
  Rosout& operator=(const Rosout&) = delete;

 private:
  void Take(const log::Record& record);
  void Run();

  const std::string node_name_;
  const Send send_;
  std::mutex mutex_;  // guards all below
  std::condition_variable changed_;
  std::deque<rcl_interfaces::msg::Log> queue_;
  std::uint64_t left_out_ = 0;
  bool stopping_ = false;
  std::chrono::steady_clock::time_point drain_until_{};  // once stopping
  std::thread sender_;
};

}  // namespace conav
