#include "common/protocol/convert.h"
#include "common/protocol/convert_checks.h"

namespace conav {

using convert::Checks;
using convert::ToCellMessage;
using convert::ToCellMessages;

namespace {

constexpr double kMaxValidFor = 1.0e6;  // seconds

void CheckConnected(Checks& checks, const std::vector<Cell>& path) {
  for (std::size_t i = 1; i < path.size(); ++i) {
    if (AreNeighbours(path[i - 1], path[i])) continue;
    return checks.Refuse(
        fmt::format("path[{}] = {} is not a neighbour of {}", i, path[i], path[i - 1]));
  }
}

EditRequest ToEditRequest(Checks& checks, const conav_msgs::msg::OperatorRequest& message) {
  EditRequest request;
  request.base_revision = message.base_revision();
  checks.Size("edits", message.edits().size(), convert::kMaxPath);
  if (checks.failed()) return request;
  for (std::size_t i = 0; i < message.edits().size() && !checks.failed(); ++i) {
    const auto& edit = message.edits()[i];
    request.edits.push_back(
        {checks.ToCell(fmt::format("edits[{}].cell", i), edit.cell()), edit.wall()});
  }
  return request;
}

GuideRequest ToGuideRequest(Checks& checks, const conav_msgs::msg::OperatorRequest& message) {
  GuideRequest request;
  request.robot = checks.Name("robot", message.robot());
  request.path = checks.Cells("path", message.path());
  request.answers_snapshot = message.answers_snapshot();
  request.valid_for_s = checks.Range("valid_for", message.valid_for(), 0.0, kMaxValidFor);
  if (request.valid_for_s <= 0.0) checks.Refuse("valid_for = 0 is not above 0");
  return request;
}

DriveAction ToDriveAction(Checks& checks, std::uint8_t value) {
  return checks.Enumerator("drive", value, DriveAction::kStop, DriveAction::kTurnRight);
}

DriveRequest ToDriveRequest(Checks& checks, const conav_msgs::msg::OperatorRequest& message) {
  DriveRequest request;
  request.robot = checks.Name("robot", message.robot());
  request.drive = ToDriveAction(checks, message.drive());
  request.expires_at = checks.Time("expires_at", message.expires_at());
  return request;
}

SelectRequest ToSelectRequest(Checks& checks, const conav_msgs::msg::OperatorRequest& message) {
  SelectRequest request;
  request.robot = checks.Name("robot", message.robot());
  request.reason = checks.Enumerator("attention_reason", message.attention_reason(),
                                     AttentionReason::kPicture, AttentionReason::kGoalsReached);
  return request;
}

void Write(const EditRequest& edit, conav_msgs::msg::OperatorRequest& message) {
  message.kind(conav_msgs::msg::OPERATOR_REQUEST_EDIT);
  message.base_revision(edit.base_revision);
  for (const CellEdit& value : edit.edits) {
    auto& cell_edit = message.edits().emplace_back();
    cell_edit.cell(ToCellMessage(value.cell));
    cell_edit.wall(value.wall);
  }
}

void Write(const GuideRequest& guide, conav_msgs::msg::OperatorRequest& message) {
  message.kind(conav_msgs::msg::OPERATOR_REQUEST_GUIDE);
  message.robot(guide.robot);
  message.path(ToCellMessages(guide.path));
  message.answers_snapshot(guide.answers_snapshot);
  message.valid_for(guide.valid_for_s);
}

void Write(const DriveRequest& drive, conav_msgs::msg::OperatorRequest& message) {
  message.kind(conav_msgs::msg::OPERATOR_REQUEST_DRIVE);
  message.robot(drive.robot);
  message.drive(static_cast<std::uint8_t>(drive.drive));
  message.expires_at(ToMessage(drive.expires_at));
}

void Write(const SelectRequest& select, conav_msgs::msg::OperatorRequest& message) {
  message.kind(conav_msgs::msg::OPERATOR_REQUEST_SELECT);
  message.robot(select.robot);
  message.attention_reason(static_cast<std::uint8_t>(select.reason));
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

Result<OperatorRequest> ToDomain(const conav_msgs::msg::OperatorRequest& message) {
  Checks checks;
  OperatorRequest request;
  request.stamp = checks.Stamp(message.header());
  request.client = checks.Client("client", message.client());
  request.request_id = message.request_id();
  if (request.request_id == 0) checks.Refuse("request_id = 0 is below 1");
  request.world = checks.Name("world", message.world());
  if (message.kind() == conav_msgs::msg::OPERATOR_REQUEST_EDIT) {
    request.body = ToEditRequest(checks, message);
  } else if (message.kind() == conav_msgs::msg::OPERATOR_REQUEST_GUIDE) {
    request.body = ToGuideRequest(checks, message);
  } else if (message.kind() == conav_msgs::msg::OPERATOR_REQUEST_DRIVE) {
    request.body = ToDriveRequest(checks, message);
  } else if (message.kind() == conav_msgs::msg::OPERATOR_REQUEST_SELECT) {
    request.body = ToSelectRequest(checks, message);
  } else {
    checks.Refuse(fmt::format("kind = {} is not in [{}, {}]", message.kind(),
                              conav_msgs::msg::OPERATOR_REQUEST_EDIT,
                              conav_msgs::msg::OPERATOR_REQUEST_SELECT));
  }
  if (checks.failed()) return checks.failure();
  return request;
}

conav_msgs::msg::OperatorRequest ToMessage(const OperatorRequest& request) {
  conav_msgs::msg::OperatorRequest message;
  message.header(ToHeader(request.stamp));
  message.client(request.client);
  message.request_id(request.request_id);
  message.world(request.world);
  std::visit([&](const auto& body) { Write(body, message); }, request.body);
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
  order.drive = ToDriveAction(checks, message.drive());
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

Result<OperatorReply> ToDomain(const conav_msgs::msg::OperatorReply& message) {
  Checks checks;
  OperatorReply reply;
  reply.client = checks.Client("client", message.client());
  reply.request_id = message.request_id();
  if (reply.request_id == 0) checks.Refuse("request_id = 0 is below 1");
  reply.accepted = message.accepted();
  reply.reason = checks.Text("reason", message.reason());
  reply.revision = message.revision();
  if (checks.failed()) return checks.failure();
  return reply;
}

conav_msgs::msg::OperatorReply ToMessage(const OperatorReply& reply) {
  conav_msgs::msg::OperatorReply message;
  message.client(reply.client);
  message.request_id(reply.request_id);
  message.accepted(reply.accepted);
  message.reason(reply.reason);
  message.revision(reply.revision);
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
  return message;
}

}  // namespace conav
