#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "console.pb.h"

namespace conav::operators {

/// The newest frame of each robot that streams. What a page has not taken when the next frame comes
/// is lost to it, on purpose.
/// Threads: safe to call concurrently.
class FrameSlots {
 public:
  struct Slot {
    std::uint64_t number = 0;  // 1, 2, ... per robot
    std::shared_ptr<const console::Frame> frame;
  };

  /// `frame` gets its number here.
  void Put(console::Frame frame);
  /// The newest of the robots whose number in `seen` is lower, by robot.
  std::map<std::string, Slot> Newer(const std::map<std::string, std::uint64_t>& seen) const;
  std::map<std::string, std::uint64_t> Numbers() const;

 private:
  mutable std::mutex mutex_;  // guards slots_
  std::map<std::string, Slot> slots_;
};

}  // namespace conav::operators
