#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/msg/supervision.h"
#include "common/runtime/clock.h"
#include "common/runtime/result.h"

// One user: the simulated operator; tests ask through it, too.

namespace conav::operators {

struct OperatorClientOptions {
  /// With a UniqueId: the operator service remembers each client's requests for ever, so a client
  /// that starts again needs another name.
  std::string client;
  double repeat_s = 0.25;
  double deadline_s = 10.0;
};

/// How a client on the bus asks the operator service for something.
///
/// Send() returns at once with the request's id; the request is repeated, unchanged, until its
/// reply came or its deadline passed, and Poll() says which. Repeats are harmless: the service
/// knows (client, id). Wall time. When the deadline passes it is not known whether the request was
/// carried out.
/// Threads: not synchronised; one owner. Nothing blocks.
class OperatorClient {
 public:
  OperatorClient(bus::Participant& participant, const Clock& clock, OperatorClientOptions options);

  /// `stamp`: simulation time at which the client asks, for the record.
  std::uint64_t Send(const std::string& world, decltype(OperatorRequest::body) body, SimTime stamp);

  /// The end of one request. Errors: kTimeout. A refusal is a reply that is not accepted.
  struct Outcome {
    std::uint64_t request_id = 0;
    Result<OperatorReply> reply;
  };

  /// Takes the replies that arrived, repeats what is due, gives up what is late. Call it whenever
  /// something arrived and at least every repeat_s.
  std::vector<Outcome> Poll();

  const std::string& name() const { return options_.client; }
  std::size_t pending() const { return pending_.size(); }

 private:
  struct Pending {
    conav_msgs::msg::OperatorRequest message;
    Clock::TimePoint repeat_at;
    Clock::TimePoint deadline;
  };

  void TakeReplies(std::vector<Outcome>& outcomes);

  const Clock& clock_;
  OperatorClientOptions options_;
  std::uint64_t last_id_ = 0;
  std::map<std::uint64_t, Pending> pending_;  // by request id
  bus::Publisher<conav_msgs::msg::OperatorRequest> requests_;
  bus::Subscriber<conav_msgs::msg::OperatorReply> replies_;
};

}  // namespace conav::operators
