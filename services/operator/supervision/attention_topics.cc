#include "operator/supervision/attention_topics.h"

#include <algorithm>
#include <chrono>

#include "common/msg/convert.h"

namespace conav::operators {
namespace {

constexpr std::chrono::seconds kPeriod{1};
/// Each load of a page is a client.
constexpr std::size_t kClientsRemembered = 64;

}  // namespace

AttentionTopics::AttentionTopics(bus::Participant& participant, const AttentionOptions& options,
                                 const Clock& clock)
    : options_(options),
      clock_(clock),
      queue_(options),
      meter_(options),
      publisher_(participant, bus::kAttentionQueue) {
  Publish({});
}

void AttentionTopics::Guided(const std::string& client, const Guidance& guidance, SimTime now) {
  queue_.Receive(guidance, now);
  meter_.Accepted(client, guidance.robot, now);
}

void AttentionTopics::Edited(const std::string& client, const std::string& world, SimTime now) {
  meter_.Accepted(client, world, now);
}

OperatorReply AttentionTopics::Select(const OperatorRequest& request, SimTime now) {
  const auto known = std::ranges::find(newest_selections_, request.client, &OperatorReply::client);
  if (known != newest_selections_.end()) {
    if (known->request_id == request.request_id) return *known;
    newest_selections_.erase(known);
  }
  if (newest_selections_.size() >= kClientsRemembered) newest_selections_.pop_front();
  OperatorReply& newest = newest_selections_.emplace_back();
  TakeArrivals(now);
  const auto selected = queue_.Select(request.client, std::get<SelectRequest>(request.body), now);
  newest = {request.client, request.request_id, selected.has_value(), "", 0};
  if (selected) {
    meter_.Selected(request.client, *selected, now);
  } else {
    newest.reason = selected.error().text;
  }
  return newest;
}

void AttentionTopics::TakeArrivals(SimTime now) {
  for (const AttentionItem& item : queue_.TakeArrivals()) meter_.Arrived(item, now);
}

void AttentionTopics::Step(SimTime now) {
  queue_.Update(meter_.times(), now);
  TakeArrivals(now);
  for (const auto& departure : queue_.TakeDepartures()) meter_.Left(departure);
  meter_.Advance(queue_.robots_at_work(), queue_.robots_waiting(), now);
  const bool changed = queue_.items() != published_.items;
  if (changed || clock_.Now() - published_at_ >= kPeriod) Publish(now);
}

void AttentionTopics::Publish(SimTime now) {
  published_ = {now, published_.revision + 1, options_.order, queue_.items(), meter_.Workload(now)};
  published_at_ = clock_.Now();
  bus::Send(publisher_, ToMessage(published_));
}

}  // namespace conav::operators
