#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/protocol/planning.h"
#include "common/runtime/clock.h"

namespace conav::nhpm {

/// A request that was taken from the bus and not answered yet.
struct OpenRequest {
  PerceptionRequest request;
  Clock::TimePoint arrived;

  /// When its asker gives up; nothing when it does not say.
  std::optional<Clock::TimePoint> deadline() const;
  /// Of all queries together: what an answer costs grows with them.
  std::size_t cells() const;
};

/// The requests that wait for a computing thread, oldest first, with a bound: who is beyond it, or
/// would be answered too late, is told at once.
///
/// How long an answer will take is guessed from the time per cell of those before it. The guess
/// turns nobody away while nothing is open: one slow answer could otherwise never be followed by a
/// faster one that mends it.
/// Threads: safe to use from several.
class RequestQueue {
 public:
  enum class Admission {
    kQueued,
    kRepeat,   // is open already and will be answered once
    kFull,     // `max_open` requests are open
    kTooSlow,  // would be answered after its deadline
  };

  RequestQueue(std::size_t max_open, int threads) : max_open_(max_open), threads_(threads) {}

  /// `offered` is moved from only when queued. A repeat lends the open one its later deadline.
  Admission Offer(OpenRequest&& offered);

  /// The oldest, or nothing. It stays open until Finish().
  std::optional<OpenRequest> Take();
  /// Blocks until there is one; nothing once the queue is closed and empty.
  std::optional<OpenRequest> WaitAndTake();
  /// `computing` is the time that it took; nothing when it was not computed.
  void Finish(const OpenRequest& taken, std::optional<std::chrono::nanoseconds> computing);
  /// Ends WaitAndTake() on all threads as soon as the rest is taken.
  void Close();

  /// Requests that wait or are computed.
  std::size_t open() const;
  /// Until a request of `cells` that came now is answered: what is open is shared by the threads,
  /// its own cells are computed by one.
  std::chrono::nanoseconds ExpectedWait(std::size_t cells) const;

 private:
  std::optional<OpenRequest> TakeLocked();
  std::chrono::nanoseconds ExpectedWaitLocked(std::size_t cells) const;

  const std::size_t max_open_;
  const int threads_;
  mutable std::mutex mutex_;  // guards all below
  std::condition_variable changed_;
  std::deque<OpenRequest> waiting_;
  std::vector<std::pair<std::string, std::uint64_t>> computing_;  // client and number
  std::size_t open_cells_ = 0;
  double seconds_per_cell_ = 0.0;  // moving average
  bool closed_ = false;
};

}  // namespace conav::nhpm
