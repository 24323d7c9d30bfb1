#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>

#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/protocol/convert.h"
#include "common/runtime/clock.h"
#include "common/runtime/stop_token.h"
#include "common/service/diagnostics.h"
#include "nhpm/config.h"
#include "nhpm/request_queue.h"
#include "nhpm/served_models.h"

namespace conav::nhpm {

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
