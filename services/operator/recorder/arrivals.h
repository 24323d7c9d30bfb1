#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <vector>

#include "operator/bag/bytes.h"

namespace conav::recorder {

/// A message as it came.
struct Arrival {
  std::uint16_t channel = 0;
  std::uint64_t log_time = 0;      // ns since 1970
  std::uint64_t publish_time = 0;  // ns: the stamp of its header, without one its log time
  bag::Bytes data;                 // CDR with its encapsulation
};

/// Messages on their way from the bus's receive threads to the thread that writes them. Their log
/// times are in order unless the wall clock is set back.
/// Threads: any for Add, one for the rest.
class Arrivals {
 public:
  using WallClock = std::function<std::uint64_t()>;  // ns since 1970

  /// When the writer is so slow that more than `limit_bytes` wait, newer ones are dropped and
  /// counted. `wake` is called when a quarter of that is reached.
  Arrivals(std::size_t limit_bytes, std::function<void()> wake, WallClock now = SystemTime);

  void Add(std::uint16_t channel, std::optional<std::uint64_t> stamp, bag::Bytes data);

  /// All that came since the last call, oldest first.
  std::vector<Arrival> Take();

  /// Since the begin.
  std::uint64_t dropped() const;

  static std::uint64_t SystemTime();

 private:
  const std::size_t limit_bytes_;
  const std::function<void()> wake_;
  const WallClock now_;
  mutable std::mutex mutex_;  // guards what follows
  std::vector<Arrival> waiting_;
  std::size_t waiting_bytes_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace conav::recorder
