#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "console.pb.h"

namespace conav::operators {

/// The newest frame of each robot that streams. A page that is too slow for a frame skips it.
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

/// JPEG pixels of the newest pictures, up to a number of bytes in all; the oldest leave first.
/// Threads: safe to call concurrently.
class SnapshotStore {
 public:
  using Pixels = std::shared_ptr<const std::vector<std::uint8_t>>;

  explicit SnapshotStore(std::size_t limit_bytes) : limit_(limit_bytes) {}

  /// Pages are answered from the bytes of `jpeg` themselves. A picture of the same robot and number
  /// is replaced. One without pixels, or larger than the limit, is not kept.
  void Put(const std::string& robot, std::uint64_t number, std::vector<std::uint8_t>&& jpeg);
  /// Null when it is not kept, or no longer.
  Pixels Find(const std::string& robot, std::uint64_t number) const;

 private:
  using Key = std::pair<std::string, std::uint64_t>;

  void EraseLocked(const Key& key);

  const std::size_t limit_;
  mutable std::mutex mutex_;  // guards all below
  std::size_t bytes_ = 0;
  std::map<Key, Pixels> pixels_;
  std::deque<Key> order_;  // oldest first
};

}  // namespace conav::operators
