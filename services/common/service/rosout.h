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

/// Publishes the log of the process on /rosout while it lives, for `ros2 topic echo /rosout` and
/// rqt_console; levels and names as in rclcpp. One per process.
///
/// A DDS vendor's own thread may log a line but must not send one, so this object sends from a
/// thread of its own. When the bus cannot keep up, the oldest lines are left out, and the next line
/// sent states how many.
class Rosout {
 public:
  /// Most lines that wait to be sent.
  static constexpr std::size_t kQueueLimit = 1000;
  static constexpr std::chrono::seconds kDrainLimit{1};

  /// Sends one line; false when the bus did not take it.
  using Send = std::function<bool(const rcl_interfaces::msg::Log&)>;

  explicit Rosout(bus::Participant& participant);
  /// The same with any way of sending, under the name `node_name`.
  Rosout(std::string node_name, Send send);
  /// Sends what waits; stops at the first failure or after kDrainLimit. Then waits up to
  /// kDrainLimit for the last lines to arrive.
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
  std::chrono::steady_clock::time_point drain_until_{};  // set when stopping
  std::thread sender_;
};

}  // namespace conav
