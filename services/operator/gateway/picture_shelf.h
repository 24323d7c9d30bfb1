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

namespace conav::operators {

/// JPEG pixels of the newest pictures, up to a number of bytes in all; the oldest leave first.
/// Threads: safe to call concurrently.
class PictureShelf {
 public:
  using Pixels = std::shared_ptr<const std::string>;

  explicit PictureShelf(std::size_t limit_bytes) : limit_(limit_bytes) {}

  /// A picture of the same robot and number is replaced. One without pixels, or larger than the
  /// limit, is not kept.
  void Put(const std::string& robot, std::uint64_t number, std::vector<std::uint8_t> jpeg);
  /// Null when it is not kept (any more).
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
