#include "operator/supervision/request_log.h"

#include <algorithm>
#include <array>

namespace conav::operators {
namespace {

/// In the order of OperatorRequest::body.
constexpr std::array kKinds{"edit",   "guide", "drive",        "select",          "answer",
                            "stop",   "go",    "take_control", "release_control", "acknowledge",
                            "shelve", "finish"};
static_assert(kKinds.size() == std::variant_size_v<decltype(OperatorRequest::body)>);

const char* KindOf(const OperatorRequest& request) { return kKinds[request.body.index()]; }

}  // namespace

bool RequestLog::RememberRefusal(const OperatorRequest& request) {
  std::pair refusal(request.client, request.request_id);
  if (std::find(refusals_.begin(), refusals_.end(), refusal) != refusals_.end()) return false;
  refusals_.push_back(std::move(refusal));
  if (refusals_.size() > kRefusalsRemembered) refusals_.pop_front();
  return true;
}

bool RequestLog::Note(const OperatorRequest& request, const BeliefStore::Answer& answer,
                      SimTime now) {
  const bool drives = std::holds_alternative<DriveRequest>(request.body);
  const OperatorReply& reply = answer.reply;
  if (reply.accepted) {
    ++accepted_;
    if (drives) return false;
    LOG_INFO("accepted", "kind", KindOf(request), "client", request.client, "id",
             request.request_id, "world", request.world, "revision", reply.revision, "sim_s",
             now.ToSeconds());
    return answer.changed;
  }
  if (!RememberRefusal(request)) return false;
  ++refused_;
  if (const auto held_back = refusals_logged_.Allow()) {
    LOG_WARNING("refused", "kind", KindOf(request), "client", request.client, "id",
                request.request_id, "world", request.world, "reason", reply.reason, "held_back",
                *held_back);
  }
  return !drives;
}

}  // namespace conav::operators
