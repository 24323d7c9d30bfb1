#include "common/protocol/convert.h"
#include "common/protocol/convert_checks.h"

namespace conav {

using convert::Checks;
using convert::ToCellMessage;
using convert::ToCellMessages;

namespace {

constexpr double kMostSeconds = 1.0e12;

void CheckConnected(Checks& checks, const std::vector<Cell>& path) {
  for (std::size_t i = 1; i < path.size(); ++i) {
    if (AreNeighbours(path[i - 1], path[i])) continue;
    return checks.Refuse(
        fmt::format("path[{}] = {} is not a neighbour of {}", i, path[i], path[i - 1]));
  }
}

}  // namespace

Result<Belief> ToDomain(const conav_msgs::msg::BeliefMap& message) {
  Checks checks;
  Belief belief;
  belief.stamp = checks.Stamp(message.header());
  belief.world = checks.Name("world", message.world());
  belief.revision = message.revision();
  if (!checks.Shape(message.rows(), message.columns())) return checks.failure();
  belief.wall_probability =
      checks.Probabilities("wall_probability", message.wall_probability(),
                           static_cast<int>(message.rows()), static_cast<int>(message.columns()));
  if (!message.edited_by().empty()) {
    belief.edited_by = checks.Client("edited_by", message.edited_by());
  }
  if (checks.failed()) return checks.failure();
  return belief;
}

conav_msgs::msg::BeliefMap ToMessage(const Belief& belief) {
  conav_msgs::msg::BeliefMap message;
  message.header(ToHeader(belief.stamp));
  message.world(belief.world);
  message.revision(belief.revision);
  message.rows(static_cast<std::uint32_t>(belief.wall_probability.rows()));
  message.columns(static_cast<std::uint32_t>(belief.wall_probability.columns()));
  message.wall_probability(convert::ToFloats(belief.wall_probability));
  message.edited_by(belief.edited_by);
  return message;
}

Result<Guidance> ToDomain(const conav_msgs::msg::Guidance& message) {
  Checks checks;
  Guidance guidance;
  guidance.stamp = checks.Stamp(message.header());
  guidance.world = checks.Name("world", message.world());
  guidance.robot = checks.Name("robot", message.robot());
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
  if (checks.failed()) return checks.failure();
  return guidance;
}

conav_msgs::msg::Guidance ToMessage(const Guidance& guidance) {
  conav_msgs::msg::Guidance message;
  message.header(ToHeader(guidance.stamp));
  message.world(guidance.world);
  message.robot(guidance.robot);
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
  order.stamp = checks.Stamp(message.header());
  order.world = checks.Name("world", message.world());
  order.robot = checks.Name("robot", message.robot());
  order.sequence_number = message.sequence_number();
  if (order.sequence_number == 0) checks.Refuse("sequence_number = 0 is below 1");
  order.drive =
      checks.Enumerator("drive", message.drive(), DriveAction::kStop, DriveAction::kTurnRight);
  if (!message.given_by().empty()) order.given_by = checks.Client("given_by", message.given_by());
  order.expires_at = checks.Time("expires_at", message.expires_at());
  if (checks.failed()) return checks.failure();
  return order;
}

conav_msgs::msg::DriveOrder ToMessage(const DriveOrder& order) {
  conav_msgs::msg::DriveOrder message;
  message.header(ToHeader(order.stamp));
  message.world(order.world);
  message.robot(order.robot);
  message.sequence_number(order.sequence_number);
  message.drive(static_cast<std::uint8_t>(order.drive));
  message.given_by(order.given_by);
  message.expires_at(ToMessage(order.expires_at));
  return message;
}

Result<HoldOrder> ToDomain(const conav_msgs::msg::HoldOrder& message) {
  Checks checks;
  HoldOrder order;
  order.stamp = checks.Stamp(message.header());
  order.world = checks.Name("world", message.world());
  order.robot = checks.Name("robot", message.robot());
  order.revision = message.revision();
  if (order.revision == 0) checks.Refuse("revision = 0 is below 1");
  order.stopped = message.stopped();
  order.given_by = checks.OptionalClient("given_by", message.given_by());
  order.reason = checks.Text("reason", message.reason());
  if (checks.failed()) return checks.failure();
  return order;
}

conav_msgs::msg::HoldOrder ToMessage(const HoldOrder& order) {
  conav_msgs::msg::HoldOrder message;
  message.header(ToHeader(order.stamp));
  message.world(order.world);
  message.robot(order.robot);
  message.revision(order.revision);
  message.stopped(order.stopped);
  message.given_by(order.given_by);
  message.reason(order.reason);
  return message;
}

Result<AttentionRequest> ToDomain(const conav_msgs::msg::AttentionRequest& message) {
  Checks checks;
  AttentionRequest request;
  request.stamp = checks.Stamp(message.header());
  request.world = checks.Name("world", message.world());
  request.robot = checks.Name("robot", message.robot());
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
  if (checks.failed()) return checks.failure();
  return request;
}

conav_msgs::msg::AttentionRequest ToMessage(const AttentionRequest& request) {
  conav_msgs::msg::AttentionRequest message;
  message.header(ToHeader(request.stamp));
  message.world(request.world);
  message.robot(request.robot);
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

}  // namespace conav
