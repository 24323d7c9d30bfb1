#pragma once

#include <chrono>
#include <cstdint>

#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/runtime/clock.h"
#include "common/runtime/stop_token.h"
#include "common/service/diagnostics.h"
#include "nhpm/config.h"
#include "nhpm/model/glpf.h"

namespace conav::nhpm {

/// Answers perception requests of any number of planners, in the order in which they arrive.
///
/// Before the first request it publishes nothing but its health. Every request that names its
/// sender gets a reply: the answers, or a refusal with its reason (malformed, another model
/// wanted). Answers depend on nothing but the request, so a repeated request gets a repeated reply,
/// and replicas agree. Input does not age: an asker that no longer waits ignores the reply.
/// Threads: Run() on one thread, which owns all state.
class NhpmService {
 public:
  struct Counts {
    std::uint64_t requests = 0;  // answered
    std::uint64_t queries = 0;   // in these
    std::uint64_t refused = 0;   // with a reply that says why
    std::uint64_t dropped = 0;   // without a sender to reply to
    std::chrono::nanoseconds busy{0};
  };

  NhpmService(bus::Participant& participant, const NhpmConfig& config, const Clock& clock);

  void Run(const StopToken& stop);
  /// One turn of Run(): waits up to `timeout` and answers all that is there. For tests.
  void RunOnce(std::chrono::nanoseconds timeout);

  const Counts& counts() const { return counts_; }

 private:
  void Answer(const conav_msgs::msg::PerceptionRequest& message);
  PerceptionReply ReplyTo(const PerceptionRequest& request) const;
  PerceptionReply Blank(const std::string& client, std::uint64_t request_id) const;
  void Count(const PerceptionReply& reply);
  Health Report() const;

  bus::Participant& participant_;
  const Clock& clock_;
  Glpf model_;
  Counts counts_;
  Diagnostics diagnostics_;
  bus::Publisher<conav_msgs::msg::PerceptionReply> replies_;
  bus::Subscriber<conav_msgs::msg::PerceptionRequest> requests_;
};

}  // namespace conav::nhpm
