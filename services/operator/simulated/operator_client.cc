#include "operator/simulated/operator_client.h"

#include <fmt/core.h>

#include "common/msg/convert.h"

namespace conav::operators {

OperatorClient::OperatorClient(bus::Participant& participant, const Clock& clock,
                               OperatorClientOptions options)
    : clock_(clock),
      options_(std::move(options)),
      requests_(participant, bus::kOperatorRequest),
      replies_(participant, bus::kOperatorReply) {
  DEMAND(!options_.client.empty());
}

std::uint64_t OperatorClient::Send(const std::string& world, decltype(OperatorRequest::body) body,
                                   SimTime stamp) {
  const OperatorRequest request{stamp, options_.client, ++last_id_, world, std::move(body)};
  const auto now = clock_.Now();
  const auto entry = pending_.emplace(request.request_id,
                                      Pending{ToMessage(request), now + Seconds(options_.repeat_s),
                                              now + Seconds(options_.deadline_s)});
  // With the in-memory bus the reply may be here before Send returns; Poll() will find it.
  bus::Send(requests_, entry.first->second.message);
  return request.request_id;
}

std::vector<OperatorClient::Outcome> OperatorClient::Poll() {
  std::vector<Outcome> outcomes;
  TakeReplies(outcomes);
  const auto now = clock_.Now();
  for (auto it = pending_.begin(); it != pending_.end();) {
    auto& [id, pending] = *it;
    if (now >= pending.deadline) {
      outcomes.push_back(
          {id, Fail(ErrorCode::kTimeout, fmt::format("request {} of {} to the operator service: no "
                                                     "reply within {} s",
                                                     id, options_.client, options_.deadline_s))});
      it = pending_.erase(it);
      continue;
    }
    if (now >= pending.repeat_at) {
      pending.repeat_at = now + Seconds(options_.repeat_s);
      bus::Send(requests_, pending.message);
    }
    ++it;
  }
  return outcomes;
}

void OperatorClient::TakeReplies(std::vector<Outcome>& outcomes) {
  for (OperatorReply& reply : replies_.TakeValid(kToDomain)) {
    if (reply.client != options_.client) continue;
    // Unknown ids are answers to repeats of something that was answered before.
    if (pending_.erase(reply.request_id) == 0) continue;
    const std::uint64_t id = reply.request_id;
    outcomes.push_back({id, std::move(reply)});
  }
}

}  // namespace conav::operators
