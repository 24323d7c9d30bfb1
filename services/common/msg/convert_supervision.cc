#include <utility>

#include "common/msg/convert.h"
#include "common/msg/convert_checks.h"

namespace conav {

using convert::Checks;
using convert::ToCellMessage;
using convert::ToCellMessages;
using convert::WriteAddress;

namespace {

constexpr double kMostSeconds = 1.0e12;

void CheckConnected(Checks& checks, const std::vector<Cell>& path) {
  if (checks.failed()) return;  // cells may be anywhere
  for (std::size_t i = 1; i < path.size(); ++i) {
    if (AreNeighbours(path[i - 1], path[i])) continue;
    return checks.Refuse(
        fmt::format("path[{}] = {} is not a neighbour of {}", i, path[i], path[i - 1]));
  }
}

constexpr std::size_t kMaxItems = 65536;
constexpr double kMost = 1.0e12;  // of seconds and of reward units
constexpr std::uint8_t kTiers = 5;

AttentionItem ToItem(Checks& checks, const conav_msgs::msg::AttentionItem& message) {
  AttentionItem item;
  item.world = checks.Name("items.world", message.world());
  item.robot = checks.Name("items.robot", message.robot());
  item.reason = checks.Enumerator("items.reason", message.reason(), AttentionReason::kSnapshot,
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

Result<Belief> ToDomain(const conav_msgs::msg::BeliefMap& message) {
  Checks checks;
  Belief belief;
  belief.stamp = checks.Stamp(message.header());
  belief.world = checks.Name("world", message.world());
  belief.revision = message.revision();
  const GridGeometry grid = checks.Geometry("map_info", message.map_info());
  if (checks.failed()) return checks.failure();
  belief.cell_size_m = grid.cell_size_m;
  belief.middle = grid.middle;
  belief.wall_probability =
      checks.Probabilities("wall_probability", message.wall_probability(), grid.rows, grid.columns);
  if (!message.edited_by().empty()) {
    belief.edited_by = checks.Client("edited_by", message.edited_by());
  }
  return checks.OrFailure(std::move(belief));
}

conav_msgs::msg::BeliefMap ToMessage(const Belief& belief) {
  conav_msgs::msg::BeliefMap message;
  message.header(ToHeader(belief.stamp));
  message.world(belief.world);
  message.revision(belief.revision);
  message.map_info(convert::ToMapInfo(belief.stamp, belief.geometry()));
  message.wall_probability(convert::ToFloats(belief.wall_probability));
  message.edited_by(belief.edited_by);
  return message;
}

Result<Guidance> ToDomain(const conav_msgs::msg::Guidance& message) {
  Checks checks;
  Guidance guidance;
  checks.Address(message, guidance);
  guidance.revision = message.revision();
  if (guidance.revision == 0) checks.Refuse("revision = 0 is below 1");
  guidance.path = checks.Cells("path", message.path());
  CheckConnected(checks, guidance.path);
  if (!message.given_by().empty()) {
    guidance.given_by = checks.Client("given_by", message.given_by());
  }
  guidance.belief_revision = message.belief_revision();
  guidance.answers_snapshot = message.answers_snapshot();
  guidance.valid_until = checks.Time("valid_until", message.valid_until());
  return checks.OrFailure(std::move(guidance));
}

conav_msgs::msg::Guidance ToMessage(const Guidance& guidance) {
  conav_msgs::msg::Guidance message;
  WriteAddress(guidance, message);
  message.revision(guidance.revision);
  message.path(ToCellMessages(guidance.path));
  message.given_by(guidance.given_by);
  message.belief_revision(guidance.belief_revision);
  message.answers_snapshot(guidance.answers_snapshot);
  message.valid_until(ToMessage(guidance.valid_until));
  return message;
}

Result<DriveOrder> ToDomain(const conav_msgs::msg::DriveOrder& message) {
  Checks checks;
  DriveOrder order;
  checks.Address(message, order);
  order.sequence_number = message.sequence_number();
  if (order.sequence_number == 0) checks.Refuse("sequence_number = 0 is below 1");
  order.drive =
      checks.Enumerator("drive", message.drive(), DriveAction::kStop, DriveAction::kTurnRight);
  if (!message.given_by().empty()) order.given_by = checks.Client("given_by", message.given_by());
  order.expires_at = checks.Time("expires_at", message.expires_at());
  return checks.OrFailure(std::move(order));
}

conav_msgs::msg::DriveOrder ToMessage(const DriveOrder& order) {
  conav_msgs::msg::DriveOrder message;
  WriteAddress(order, message);
  message.sequence_number(order.sequence_number);
  message.drive(static_cast<std::uint8_t>(order.drive));
  message.given_by(order.given_by);
  message.expires_at(ToMessage(order.expires_at));
  return message;
}

Result<StopOrder> ToDomain(const conav_msgs::msg::StopOrder& message) {
  Checks checks;
  StopOrder order;
  checks.Address(message, order);
  order.revision = message.revision();
  if (order.revision == 0) checks.Refuse("revision = 0 is below 1");
  order.stopped = message.stopped();
  order.given_by = checks.OptionalClient("given_by", message.given_by());
  order.reason = checks.Text("reason", message.reason());
  return checks.OrFailure(std::move(order));
}

conav_msgs::msg::StopOrder ToMessage(const StopOrder& order) {
  conav_msgs::msg::StopOrder message;
  WriteAddress(order, message);
  message.revision(order.revision);
  message.stopped(order.stopped);
  message.given_by(order.given_by);
  message.reason(order.reason);
  return message;
}

Result<AttentionRequest> ToDomain(const conav_msgs::msg::AttentionRequest& message) {
  Checks checks;
  AttentionRequest request;
  checks.Address(message, request);
  request.sequence_number = message.sequence_number();
  request.reason = checks.Enumerator("reason", message.reason(), AttentionReason::kNone,
                                     AttentionReason::kNoGuidance);
  request.cell = checks.ToCell("cell", message.cell());
  request.newest_snapshot = message.newest_snapshot();
  request.value_lost_per_s =
      checks.Finite("value_lost_per_second", message.value_lost_per_second());
  request.expected_information =
      checks.Finite("expected_information", message.expected_information());
  request.gives_up_at = checks.Time("gives_up_at", message.gives_up_at());
  request.gives_up_after_s =
      checks.Range("gives_up_after", message.gives_up_after(), 0.0, kMostSeconds);
  return checks.OrFailure(std::move(request));
}

conav_msgs::msg::AttentionRequest ToMessage(const AttentionRequest& request) {
  conav_msgs::msg::AttentionRequest message;
  WriteAddress(request, message);
  message.sequence_number(request.sequence_number);
  message.reason(static_cast<std::uint8_t>(request.reason));
  message.cell(ToCellMessage(request.cell));
  message.newest_snapshot(request.newest_snapshot);
  message.value_lost_per_second(request.value_lost_per_s);
  message.expected_information(request.expected_information);
  message.gives_up_at(ToMessage(request.gives_up_at));
  message.gives_up_after(request.gives_up_after_s);
  return message;
}

using convert::Checks;
using convert::ToCellMessage;

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
  return checks.OrFailure(std::move(queue));
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
