#include "common/msg/convert.h"
#include "common/msg/convert_checks.h"

namespace conav {

using convert::Checks;
using convert::ToCellMessage;
using convert::ToCellMessages;

namespace {

constexpr double kMaxValidFor = 1.0e6;  // seconds

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

DriveRequest ToDriveRequest(Checks& checks, const conav_msgs::msg::OperatorRequest& message) {
  DriveRequest request;
  request.robot = checks.Name("robot", message.robot());
  request.drive =
      checks.Enumerator("drive", message.drive(), DriveAction::kStop, DriveAction::kTurnRight);
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

std::vector<std::string> ToRobots(Checks& checks, const conav_msgs::msg::OperatorRequest& message) {
  checks.Size("robots", message.robots().size(), convert::kMaxRobots);
  if (checks.failed()) return {};
  std::vector<std::string> robots;
  for (std::size_t i = 0; i < message.robots().size(); ++i) {
    robots.push_back(checks.Name(fmt::format("robots[{}]", i), message.robots()[i]));
  }
  return robots;
}

AnswerRequest ToAnswerRequest(Checks& checks, const conav_msgs::msg::OperatorRequest& message) {
  if (message.answers_snapshot() == 0) checks.Refuse("answers_snapshot = 0 is below 1");
  return {checks.Name("robot", message.robot()), message.answers_snapshot()};
}

ShelveRequest ToShelveRequest(Checks& checks, const conav_msgs::msg::OperatorRequest& message) {
  const double duration = checks.Range("duration", message.duration(), 0.0, kMaxValidFor);
  if (duration <= 0.0) checks.Refuse("duration = 0 is not above 0");
  return {message.alert(), duration};
}

/// False for an unknown kind of request.
bool ReadBody(Checks& checks, const conav_msgs::msg::OperatorRequest& message,
              OperatorRequest& request) {
  namespace msg = conav_msgs::msg;
  switch (message.kind()) {
    case msg::OPERATOR_REQUEST_EDIT:
      request.body = ToEditRequest(checks, message);
      return true;
    case msg::OPERATOR_REQUEST_GUIDE:
      request.body = ToGuideRequest(checks, message);
      return true;
    case msg::OPERATOR_REQUEST_DRIVE:
      request.body = ToDriveRequest(checks, message);
      return true;
    case msg::OPERATOR_REQUEST_SELECT:
      request.body = ToSelectRequest(checks, message);
      return true;
    case msg::OPERATOR_REQUEST_ANSWER:
      request.body = ToAnswerRequest(checks, message);
      return true;
    case msg::OPERATOR_REQUEST_STOP:
      request.body =
          StopRequest{ToRobots(checks, message), checks.Text("reason", message.reason())};
      return true;
    case msg::OPERATOR_REQUEST_GO:
      request.body = GoRequest{ToRobots(checks, message)};
      return true;
    case msg::OPERATOR_REQUEST_TAKE_CONTROL:
      request.body =
          TakeControlRequest{ToRobots(checks, message), checks.Text("reason", message.reason())};
      return true;
    case msg::OPERATOR_REQUEST_RELEASE_CONTROL:
      request.body = ReleaseControlRequest{ToRobots(checks, message)};
      return true;
    case msg::OPERATOR_REQUEST_ACKNOWLEDGE:
      request.body = AcknowledgeRequest{message.alert()};
      return true;
    case msg::OPERATOR_REQUEST_SHELVE:
      request.body = ToShelveRequest(checks, message);
      return true;
    case msg::OPERATOR_REQUEST_FINISH:
      request.body = FinishRequest{};
      return true;
    default:
      return false;
  }
}

bool NamesWorld(const OperatorRequest& request) {
  return std::holds_alternative<EditRequest>(request.body) ||
         std::holds_alternative<GuideRequest>(request.body) ||
         std::holds_alternative<DriveRequest>(request.body) ||
         std::holds_alternative<SelectRequest>(request.body) ||
         std::holds_alternative<AnswerRequest>(request.body);
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

void Write(const AnswerRequest& answer, conav_msgs::msg::OperatorRequest& message) {
  message.kind(conav_msgs::msg::OPERATOR_REQUEST_ANSWER);
  message.robot(answer.robot);
  message.answers_snapshot(answer.snapshot);
}

void Write(const StopRequest& stop, conav_msgs::msg::OperatorRequest& message) {
  message.kind(conav_msgs::msg::OPERATOR_REQUEST_STOP);
  message.robots(stop.robots);
  message.reason(stop.reason);
}

void Write(const GoRequest& go, conav_msgs::msg::OperatorRequest& message) {
  message.kind(conav_msgs::msg::OPERATOR_REQUEST_GO);
  message.robots(go.robots);
}

void Write(const TakeControlRequest& take, conav_msgs::msg::OperatorRequest& message) {
  message.kind(conav_msgs::msg::OPERATOR_REQUEST_TAKE_CONTROL);
  message.robots(take.robots);
  message.reason(take.reason);
}

void Write(const ReleaseControlRequest& release, conav_msgs::msg::OperatorRequest& message) {
  message.kind(conav_msgs::msg::OPERATOR_REQUEST_RELEASE_CONTROL);
  message.robots(release.robots);
}

void Write(const AcknowledgeRequest& acknowledge, conav_msgs::msg::OperatorRequest& message) {
  message.kind(conav_msgs::msg::OPERATOR_REQUEST_ACKNOWLEDGE);
  message.alert(acknowledge.alert);
}

void Write(const ShelveRequest& shelve, conav_msgs::msg::OperatorRequest& message) {
  message.kind(conav_msgs::msg::OPERATOR_REQUEST_SHELVE);
  message.alert(shelve.alert);
  message.duration(shelve.duration_s);
}

void Write(const FinishRequest&, conav_msgs::msg::OperatorRequest& message) {
  message.kind(conav_msgs::msg::OPERATOR_REQUEST_FINISH);
}

}  // namespace

Result<OperatorRequest> ToDomain(const conav_msgs::msg::OperatorRequest& message) {
  Checks checks;
  OperatorRequest request;
  request.stamp = checks.Stamp(message.header());
  request.client = checks.Client("client", message.client());
  request.request_id = message.request_id();
  if (request.request_id == 0) checks.Refuse("request_id = 0 is below 1");
  if (!ReadBody(checks, message, request)) {
    checks.Refuse(fmt::format("kind = {} is not in [{}, {}]", message.kind(),
                              conav_msgs::msg::OPERATOR_REQUEST_EDIT,
                              conav_msgs::msg::OPERATOR_REQUEST_FINISH));
  }
  request.world = NamesWorld(request) ? checks.Name("world", message.world())
                                      : checks.OptionalName("world", message.world());
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

}  // namespace conav
