#include <utility>

#include "common/msg/convert.h"
#include "common/msg/convert_checks.h"

namespace conav {

using convert::Checks;
using convert::ToCellMessage;
using convert::ToCellMessages;

namespace {

namespace kinds = conav_msgs::msg::OperatorRequest_Constants;

std::vector<Cell> ToCells(const std::vector<conav_msgs::msg::Cell>& message) {
  std::vector<Cell> cells;
  cells.reserve(message.size());
  for (const auto& cell : message) cells.push_back({cell.row(), cell.column()});
  return cells;
}

std::vector<Position> ToPlaces(const std::vector<geometry_msgs::msg::Point>& message) {
  std::vector<Position> places;
  places.reserve(message.size());
  for (const auto& point : message) places.push_back({point.x(), point.y()});
  return places;
}

EditRequest ToEditRequest(const conav_msgs::msg::OperatorRequest& message) {
  EditRequest request{message.base_revision(), {}};
  for (const auto& edit : message.edits()) {
    request.edits.push_back({{edit.cell().row(), edit.cell().column()}, edit.wall()});
  }
  return request;
}

/// Copies the values, which Checked() checks. False for an unknown kind of request.
bool ReadBody(Checks& checks, const conav_msgs::msg::OperatorRequest& message,
              OperatorRequest& request) {
  switch (message.kind()) {
    case kinds::OPERATOR_REQUEST_EDIT:
      request.body = ToEditRequest(message);
      return true;
    case kinds::OPERATOR_REQUEST_GUIDE:
      request.body = GuideRequest{message.robot(), ToCells(message.path()),
                                  message.answers_snapshot(), message.valid_for()};
      return true;
    case kinds::OPERATOR_REQUEST_DRIVE:
      request.body = DriveRequest{message.robot(), static_cast<DriveAction>(message.drive()),
                                  checks.Time("expires_at", message.expires_at())};
      return true;
    case kinds::OPERATOR_REQUEST_SELECT:
      request.body =
          SelectRequest{message.robot(), static_cast<AttentionReason>(message.attention_reason())};
      return true;
    case kinds::OPERATOR_REQUEST_ANSWER:
      request.body = AnswerRequest{message.robot(), message.answers_snapshot()};
      return true;
    case kinds::OPERATOR_REQUEST_STOP:
      request.body = StopRequest{message.robots(), message.reason()};
      return true;
    case kinds::OPERATOR_REQUEST_RESUME:
      request.body = ResumeRequest{message.robots()};
      return true;
    case kinds::OPERATOR_REQUEST_TAKE_CONTROL:
      request.body = TakeControlRequest{message.robots(), message.reason(), message.ask()};
      return true;
    case kinds::OPERATOR_REQUEST_RELEASE_CONTROL:
      request.body = ReleaseControlRequest{message.robots(), message.to_client()};
      return true;
    case kinds::OPERATOR_REQUEST_ACKNOWLEDGE:
      request.body = AcknowledgeRequest{message.alert()};
      return true;
    case kinds::OPERATOR_REQUEST_SHELVE:
      request.body = ShelveRequest{message.alert(), message.duration()};
      return true;
    case kinds::OPERATOR_REQUEST_FINISH:
      request.body = FinishRequest{};
      return true;
    case kinds::OPERATOR_REQUEST_GOALS:
      request.body = GoalsRequest{message.robot(), ToPlaces(message.add_goals()),
                                  ToPlaces(message.remove_goals())};
      return true;
    case kinds::OPERATOR_REQUEST_NOTE:
      request.body = NoteRequest{message.reason()};
      return true;
    default:
      return false;
  }
}

void Write(const EditRequest& edit, conav_msgs::msg::OperatorRequest& message) {
  message.kind(kinds::OPERATOR_REQUEST_EDIT);
  message.base_revision(edit.base_revision);
  for (const CellEdit& value : edit.edits) {
    auto& cell_edit = message.edits().emplace_back();
    cell_edit.cell(ToCellMessage(value.cell));
    cell_edit.wall(value.wall);
  }
}

void Write(const GuideRequest& guide, conav_msgs::msg::OperatorRequest& message) {
  message.kind(kinds::OPERATOR_REQUEST_GUIDE);
  message.robot(guide.robot);
  message.path(ToCellMessages(guide.path));
  message.answers_snapshot(guide.answers_snapshot);
  message.valid_for(guide.valid_for_s);
}

void Write(const DriveRequest& drive, conav_msgs::msg::OperatorRequest& message) {
  message.kind(kinds::OPERATOR_REQUEST_DRIVE);
  message.robot(drive.robot);
  message.drive(static_cast<std::uint8_t>(drive.drive));
  message.expires_at(ToMessage(drive.expires_at));
}

void Write(const SelectRequest& select, conav_msgs::msg::OperatorRequest& message) {
  message.kind(kinds::OPERATOR_REQUEST_SELECT);
  message.robot(select.robot);
  message.attention_reason(static_cast<std::uint8_t>(select.reason));
}

void Write(const AnswerRequest& answer, conav_msgs::msg::OperatorRequest& message) {
  message.kind(kinds::OPERATOR_REQUEST_ANSWER);
  message.robot(answer.robot);
  message.answers_snapshot(answer.snapshot);
}

void Write(const StopRequest& stop, conav_msgs::msg::OperatorRequest& message) {
  message.kind(kinds::OPERATOR_REQUEST_STOP);
  message.robots(stop.robots);
  message.reason(stop.reason);
}

void Write(const ResumeRequest& resume, conav_msgs::msg::OperatorRequest& message) {
  message.kind(kinds::OPERATOR_REQUEST_RESUME);
  message.robots(resume.robots);
}

void Write(const TakeControlRequest& take, conav_msgs::msg::OperatorRequest& message) {
  message.kind(kinds::OPERATOR_REQUEST_TAKE_CONTROL);
  message.robots(take.robots);
  message.reason(take.reason);
  message.ask(take.ask);
}

void Write(const ReleaseControlRequest& release, conav_msgs::msg::OperatorRequest& message) {
  message.kind(kinds::OPERATOR_REQUEST_RELEASE_CONTROL);
  message.robots(release.robots);
  message.to_client(release.to_client);
}

void Write(const AcknowledgeRequest& acknowledge, conav_msgs::msg::OperatorRequest& message) {
  message.kind(kinds::OPERATOR_REQUEST_ACKNOWLEDGE);
  message.alert(acknowledge.alert);
}

void Write(const ShelveRequest& shelve, conav_msgs::msg::OperatorRequest& message) {
  message.kind(kinds::OPERATOR_REQUEST_SHELVE);
  message.alert(shelve.alert);
  message.duration(shelve.duration_s);
}

void Write(const FinishRequest&, conav_msgs::msg::OperatorRequest& message) {
  message.kind(kinds::OPERATOR_REQUEST_FINISH);
}

void Write(const GoalsRequest& goals, conav_msgs::msg::OperatorRequest& message) {
  message.kind(kinds::OPERATOR_REQUEST_GOALS);
  message.robot(goals.robot);
  for (const Position place : goals.add) message.add_goals().push_back(convert::ToPoint(place));
  for (const Position place : goals.remove) {
    message.remove_goals().push_back(convert::ToPoint(place));
  }
}

void Write(const NoteRequest& note, conav_msgs::msg::OperatorRequest& message) {
  message.kind(kinds::OPERATOR_REQUEST_NOTE);
  message.reason(note.text);
}

}  // namespace

Result<OperatorRequest> ToDomain(const conav_msgs::msg::OperatorRequest& message) {
  Checks checks;
  OperatorRequest request;
  request.stamp = checks.Stamp(message.header());
  request.client = message.client();
  request.request_id = message.request_id();
  request.world = message.world();
  if (!ReadBody(checks, message, request)) {
    checks.Refuse(fmt::format("kind = {} is not in [{}, {}]", message.kind(),
                              kinds::OPERATOR_REQUEST_EDIT, kinds::OPERATOR_REQUEST_NOTE));
  }
  if (checks.failed()) return checks.failure();
  return Checked(std::move(request));
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
  checks.AtLeastOne("request_id", reply.request_id);
  reply.accepted = message.accepted();
  reply.reason = checks.Text("reason", message.reason());
  reply.revision = message.revision();
  return checks.OrFailure(std::move(reply));
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

Result<OperatorEvent> ToDomain(const conav_msgs::msg::OperatorEvent& message) {
  Checks checks;
  OperatorEvent event;
  event.stamp = checks.Stamp(message.header());
  event.kind = checks.Enumerator("kind", message.kind(), RequestKind::kEdit, RequestKind::kNote);
  event.accepted = message.accepted();
  event.client = checks.Client("client", message.client());
  event.world = checks.OptionalName("world", message.world());
  event.robot = checks.OptionalName("robot", message.robot());
  event.text = checks.Text("text", message.text());
  event.cells = message.cells();
  event.revision = message.revision();
  return checks.OrFailure(std::move(event));
}

conav_msgs::msg::OperatorEvent ToMessage(const OperatorEvent& event) {
  conav_msgs::msg::OperatorEvent message;
  message.header(ToHeader(event.stamp));
  message.kind(static_cast<std::uint8_t>(event.kind));
  message.accepted(event.accepted);
  message.client(event.client);
  message.world(event.world);
  message.robot(event.robot);
  message.text(event.text);
  message.cells(event.cells);
  message.revision(event.revision);
  return message;
}

}  // namespace conav
