#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/publisher.h"
#include "common/bus/services.h"
#include "common/bus/subscriber.h"
#include "common/runtime/log.h"

/// ROS 2 services: a request and one reply, over two topics, encoded as the vendor's own RMW does.
/// So a ROS 2 node reaches a service of conav if both use the same vendor, as among ROS 2 nodes.
namespace conav::bus {

/// The two DDS topics of service "/r1/stop": "rq/r1/stopRequest" and "rr/r1/stopReply".
inline std::string RequestTopic(const std::string& service) { return "rq" + service + "Request"; }
inline std::string ReplyTopic(const std::string& service) { return "rr" + service + "Reply"; }

/// A ROS 2 service that this process offers. Constructing connects, destroying disconnects.
/// Threads: one at a time.
template <class Request, class Response>
class ServiceServer {
 public:
  struct Call {
    RequestId id;
    Request request;
  };

  /// Without `notifier`, requests end the Wait() of the participant.
  ServiceServer(Participant& participant, const Service<Request, Response>& service,
                std::string_view entity, Notifier* notifier = nullptr)
      : ServiceServer(participant, service.NameFor(entity), notifier) {}
  ServiceServer(Participant& participant, const std::string& name, Notifier* notifier = nullptr)
      : requests_(participant, {RequestTopic(name), kServiceQos, {}, {}}, {},
                  typename Subscriber<Envelope<Request>>::Handler(), notifier),
        replies_(participant, {ReplyTopic(name), kServiceQos, {}, {}}) {}

  /// The requests since the last call. Each may be answered now or later; sends the replies that
  /// waited, so call it often.
  std::vector<Call> Take() {
    Flush();
    std::vector<Call> calls;
    for (Envelope<Request>& taken : requests_.Take()) {
      calls.push_back({taken.id, std::move(taken.message)});
    }
    return calls;
  }

  /// A client that was just discovered may not be there yet for the replies: then they wait, for
  /// kDiscoveryLimit at most.
  void Reply(const RequestId& id, Response response) {
    waiting_.push_back({{id, std::move(response)}, std::chrono::steady_clock::now()});
    Flush();
  }

  /// Answers each request at once by `answer`, a Request -> Response.
  template <class Answer>
  void Serve(Answer&& answer) {
    for (Call& call : Take()) Reply(call.id, answer(call.request));
  }

  static constexpr std::chrono::seconds kDiscoveryLimit{2};

 private:
  struct Waiting {
    Envelope<Response> reply;
    std::chrono::steady_clock::time_point since;
  };

  void Flush() {
    while (!waiting_.empty()) {
      Waiting& first = waiting_.front();
      const bool all_there = replies_.matched_subscribers() >= requests_.matched_publishers();
      if (!all_there && std::chrono::steady_clock::now() - first.since < kDiscoveryLimit) return;
      Send(replies_, first.reply);
      waiting_.pop_front();
    }
  }

  Subscriber<Envelope<Request>> requests_;
  Publisher<Envelope<Response>> replies_;
  std::deque<Waiting> waiting_;
};

/// Calls a ROS 2 service. Constructing connects, destroying disconnects.
/// Threads: one at a time.
template <class Request, class Response>
class ServiceClient {
 public:
  struct Reply {
    std::int64_t number;
    Response response;
  };

  ServiceClient(Participant& participant, const std::string& name)
      : replies_(participant, {ReplyTopic(name), kServiceQos, {}, {}}),
        requests_(participant, {RequestTopic(name), kServiceQos, {}, {}}) {}

  /// Whether a server is there and has had time to discover this client.
  bool IsReady() {
    const auto now = std::chrono::steady_clock::now();
    if (requests_.matched_subscribers() == 0 || replies_.matched_publishers() == 0) {
      matched_at_.reset();
      return false;
    }
    if (!matched_at_) matched_at_ = now;
    return now - *matched_at_ >= kSettleTime;
  }

  /// Sends; the reply will have the number. None = the bus did not take it (logged).
  std::optional<std::int64_t> Call(Request request) {
    Envelope<Request> envelope{{replies_.client_id(), ++sent_}, std::move(request)};
    if (const auto sent = requests_.Publish(envelope); !sent) {
      LOG_WARNING("request not sent", "reason", sent.error().text);
      return std::nullopt;
    }
    return envelope.id.number;
  }

  /// Replies to this client since the last call.
  std::vector<Reply> Take() {
    std::vector<Reply> mine;
    for (Envelope<Response>& reply : replies_.Take()) {
      if (reply.id.client != replies_.client_id()) continue;
      mine.push_back({reply.id.number, std::move(reply.message)});
    }
    return mine;
  }

  static constexpr std::chrono::milliseconds kSettleTime{200};

 private:
  Subscriber<Envelope<Response>> replies_;
  Publisher<Envelope<Request>> requests_;
  std::int64_t sent_ = 0;
  std::optional<std::chrono::steady_clock::time_point> matched_at_;
};

}  // namespace conav::bus
