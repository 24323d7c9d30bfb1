#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/msg/convert.h"
#include "common/msg/planning.h"
#include "common/runtime/clock.h"
#include "common/runtime/threads.h"
#include "common/service/diagnostics.h"
#include "nhpm/config.h"
#include "nhpm/served_models.h"

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

/// Answers perception requests of any number of planners, begun in the order in which they arrive.
///
/// Before the first request it publishes nothing but its health. Every request that names its
/// sender gets one reply: the answers, a refusal with its reason (malformed, another model wanted,
/// a grid that the model was not made for), or "busy" at once when it would be answered too late or
/// too many are open. A request whose deadline passed while it waited is not computed, but answered
/// "busy". Answers depend on nothing but the request and the model that the reply names, so a
/// repeated request gets a repeated reply, and replicas agree. Requests for another replica are
/// left to that one. Weights are watched (ServedModels).
/// Threads: Run() receives on its own thread and computes on `config.threads` others.
class NhpmService {
 public:
  struct Counts {
    std::uint64_t requests = 0;  // answered
    std::uint64_t queries = 0;   // in these
    std::uint64_t refused = 0;   // with a reply that says why
    std::uint64_t busy = 0;      // answered "busy"
    std::uint64_t late = 0;      // of these, because the deadline passed in the queue
    std::uint64_t dropped = 0;   // without a sender to reply to
    std::chrono::nanoseconds computing{0};
  };

  /// Throws StartupError (ServedModels).
  NhpmService(bus::Participant& participant, const NhpmConfig& config, const Clock& clock);

  /// Until `stop`; what is open then is answered before it returns.
  void Run(const StopToken& stop);

  /// The two halves of Run() on the calling thread, for tests: waits up to `timeout` and takes in
  /// what is there; answers all that waits.
  void Receive(std::chrono::nanoseconds timeout);
  void AnswerOpen();

  Counts counts() const;

 private:
  void Admit(const conav_msgs::msg::PerceptionRequest& message);
  void Answer(const OpenRequest& open);
  PerceptionReply ReplyTo(const PerceptionRequest& request) const;
  PerceptionReply Blank(const PerceptionRequest& request, const ModelIdentity& identity) const;
  void Send(const PerceptionReply& reply);
  void Count(const PerceptionReply& reply);
  void Drop(const std::string& reason);
  void SendWithout(const PerceptionRequest& request, PerceptionStatus status, std::string reason);
  void RefreshModels();
  Health Report() const;

  bus::Participant& participant_;
  const Clock& clock_;
  const int threads_;
  ServedModels models_;
  Clock::TimePoint next_refresh_;
  RequestQueue queue_;
  mutable std::mutex mutex_;  // guards counts_
  Counts counts_;
  Diagnostics diagnostics_;
  bus::Publisher<conav_msgs::msg::PerceptionReply> replies_;
  bus::Subscriber<conav_msgs::msg::PerceptionRequest> requests_;
};

}  // namespace conav::nhpm
