#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace conav::bus {

/// Lets one thread sleep until any of many receive threads has something for it.
class Notifier {
 public:
  void Notify() {
    {
      const std::lock_guard lock(mutex_);
      pending_ = true;
    }
    condition_.notify_one();
  }

  /// False when `timeout` passed without a Notify() since the last return.
  bool Wait(std::chrono::nanoseconds timeout) {
    std::unique_lock lock(mutex_);
    const bool notified = condition_.wait_for(lock, timeout, [this] { return pending_; });
    pending_ = false;
    return notified;
  }

 private:
  std::mutex mutex_;  // guards pending_
  std::condition_variable condition_;
  bool pending_ = false;
};

}  // namespace conav::bus
