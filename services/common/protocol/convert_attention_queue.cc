#include "common/protocol/convert.h"
#include "common/protocol/convert_checks.h"

namespace conav {

using convert::Checks;
using convert::ToCellMessage;

namespace {

constexpr std::size_t kMaxItems = 65536;
constexpr double kMost = 1.0e12;  // of seconds and of reward units
constexpr std::uint8_t kTiers = 5;

AttentionItem ToItem(Checks& checks, const conav_msgs::msg::AttentionItem& message) {
  AttentionItem item;
  item.world = checks.Name("items.world", message.world());
  item.robot = checks.Name("items.robot", message.robot());
  item.reason = checks.Enumerator("items.reason", message.reason(), AttentionReason::kPicture,
                                  AttentionReason::kGoalsReached);
  item.tier = message.tier();
  if (item.tier < 1 || item.tier > kTiers) {
    checks.Refuse(fmt::format("items.tier = {} is not in [1, {}]", item.tier, kTiers));
  }
  item.since = checks.Time("items.since", message.since());
  item.deadline = checks.Time("items.deadline", message.deadline());
  item.gives_up_after_s =
      checks.Range("items.gives_up_after", message.gives_up_after(), 0.0, kMost);
  item.cell = checks.ToCell("items.cell", message.cell());
  item.newest_snapshot = message.newest_snapshot();
  item.source_sequence = message.source_sequence();
  item.value_lost_per_s =
      checks.Finite("items.value_lost_per_second", message.value_lost_per_second());
  item.expected_information =
      checks.Finite("items.expected_information", message.expected_information());
  item.expected_interaction_s =
      checks.Range("items.expected_interaction", message.expected_interaction(), 0.0, kMost);
  item.score = checks.Finite("items.score", message.score());
  item.selected_by = checks.OptionalClient("items.selected_by", message.selected_by());
  return item;
}

conav_msgs::msg::AttentionItem ToMessage(const AttentionItem& item) {
  conav_msgs::msg::AttentionItem message;
  message.world(item.world);
  message.robot(item.robot);
  message.reason(static_cast<std::uint8_t>(item.reason));
  message.tier(item.tier);
  message.since(conav::ToMessage(item.since));
  message.deadline(conav::ToMessage(item.deadline));
  message.gives_up_after(item.gives_up_after_s);
  message.cell(ToCellMessage(item.cell));
  message.newest_snapshot(item.newest_snapshot);
  message.source_sequence(item.source_sequence);
  message.value_lost_per_second(item.value_lost_per_s);
  message.expected_information(item.expected_information);
  message.expected_interaction(item.expected_interaction_s);
  message.score(item.score);
  message.selected_by(item.selected_by);
  return message;
}

OperatorWorkload ToWorkload(Checks& checks, const conav_msgs::msg::AttentionQueue& message) {
  const auto seconds = [&checks](std::string_view field, double value) {
    return checks.Range(field, value, 0.0, kMost);
  };
  OperatorWorkload workload;
  workload.robots = message.robots();
  workload.interactions = message.interactions();
  workload.abandoned = message.abandoned();
  workload.observed_s = seconds("observed", message.observed());
  workload.busy_s = seconds("busy", message.busy());
  workload.interaction_time_s = seconds("interaction_time", message.interaction_time());
  workload.neglect_time_s = seconds("neglect_time", message.neglect_time());
  workload.waiting_time_s = seconds("waiting_time", message.waiting_time());
  workload.waiting_time_p95_s = seconds("waiting_time_p95", message.waiting_time_p95());
  workload.value_lost = checks.Finite("value_lost", message.value_lost());
  workload.utilisation = checks.Range("utilisation", message.utilisation(), 0.0, 1.0);
  workload.attended_robots = seconds("attended_robots", message.attended_robots());
  workload.fan_out = seconds("fan_out", message.fan_out());
  workload.fan_out_with_waits = seconds("fan_out_with_waits", message.fan_out_with_waits());
  workload.predicted_utilisation =
      checks.Range("predicted_utilisation", message.predicted_utilisation(), 0.0, 1.0);
  workload.predicted_waiting_time_s =
      seconds("predicted_waiting_time", message.predicted_waiting_time());
  return workload;
}

}  // namespace

Result<AttentionQueueState> ToDomain(const conav_msgs::msg::AttentionQueue& message) {
  Checks checks;
  AttentionQueueState queue;
  queue.stamp = checks.Stamp(message.header());
  queue.revision = message.revision();
  queue.order = checks.Name("order", message.order());
  checks.Size("items", message.items().size(), kMaxItems);
  if (checks.failed()) return checks.failure();
  for (const auto& item : message.items()) queue.items.push_back(ToItem(checks, item));
  queue.workload = ToWorkload(checks, message);
  if (checks.failed()) return checks.failure();
  return queue;
}

conav_msgs::msg::AttentionQueue ToMessage(const AttentionQueueState& queue) {
  const OperatorWorkload& workload = queue.workload;
  conav_msgs::msg::AttentionQueue message;
  message.header(ToHeader(queue.stamp));
  message.revision(queue.revision);
  message.order(queue.order);
  for (const AttentionItem& item : queue.items) message.items().push_back(ToMessage(item));
  message.robots(workload.robots);
  message.interactions(workload.interactions);
  message.abandoned(workload.abandoned);
  message.observed(workload.observed_s);
  message.busy(workload.busy_s);
  message.interaction_time(workload.interaction_time_s);
  message.neglect_time(workload.neglect_time_s);
  message.waiting_time(workload.waiting_time_s);
  message.waiting_time_p95(workload.waiting_time_p95_s);
  message.value_lost(workload.value_lost);
  message.utilisation(workload.utilisation);
  message.attended_robots(workload.attended_robots);
  message.fan_out(workload.fan_out);
  message.fan_out_with_waits(workload.fan_out_with_waits);
  message.predicted_utilisation(workload.predicted_utilisation);
  message.predicted_waiting_time(workload.predicted_waiting_time_s);
  return message;
}

}  // namespace conav
