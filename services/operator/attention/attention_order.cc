#include "operator/attention/attention_order.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include "common/runtime/clock.h"

namespace conav::operators {
namespace {

std::int64_t DeadlineOf(const AttentionItem& item, const AttentionOptions& options) {
  if (item.deadline.nanoseconds > 0) return item.deadline.nanoseconds;
  if (item.gives_up_after_s > 0.0) {
    return (item.since + Seconds(item.gives_up_after_s)).nanoseconds;
  }
  if (!IsQuestion(item.reason)) return std::numeric_limits<std::int64_t>::max();
  return (item.since + Seconds(options.default_deadline_s)).nanoseconds;
}

auto AgeKey(const AttentionItem& item) {
  return std::tie(item.since, item.world, item.robot, item.reason);
}

}  // namespace

const std::vector<std::string>& AttentionOrders() {
  static const std::vector<std::string> orders{"priority", "fifo", "nearest_deadline"};
  return orders;
}

std::uint8_t TierOf(AttentionReason reason) {
  switch (reason) {
    case AttentionReason::kCommandFailed:
      return 1;
    case AttentionReason::kLinkLost:
      return 2;
    case AttentionReason::kBlocked:
    case AttentionReason::kNoGuidance:
    case AttentionReason::kFirstPath:
      return 3;
    case AttentionReason::kPicture:
      return 4;
    default:
      return 5;
  }
}

bool IsQuestion(AttentionReason reason) {
  return reason == AttentionReason::kPicture || TierOf(reason) == 3;
}

bool ComesBefore(const AttentionItem& a, const AttentionItem& b, const AttentionOptions& options) {
  if (options.order == "priority") {
    if (a.tier != b.tier) return a.tier < b.tier;
    if (a.score != b.score) return a.score > b.score;
  } else if (options.order == "nearest_deadline") {
    const auto deadline_a = DeadlineOf(a, options);
    const auto deadline_b = DeadlineOf(b, options);
    if (deadline_a != deadline_b) return deadline_a < deadline_b;
  }
  return AgeKey(a) < AgeKey(b);
}

void SortItems(std::vector<AttentionItem>& items, const AttentionOptions& options) {
  std::sort(items.begin(), items.end(), [&](const AttentionItem& a, const AttentionItem& b) {
    return ComesBefore(a, b, options);
  });
}

}  // namespace conav::operators
