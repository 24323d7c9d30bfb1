#include "operator/gateway/convert_request.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "common/msg/convert.h"

namespace conav::operators {
namespace {

using Message = conav_msgs::msg::OperatorRequest;

conav_msgs::msg::Cell ToCellMessage(const console::Cell& cell) {
  conav_msgs::msg::Cell message;
  message.row(cell.row());
  message.column(cell.column());
  return message;
}

void Write(const console::Edit& edit, Message& message) {
  message.kind(conav_msgs::msg::OPERATOR_REQUEST_EDIT);
  message.base_revision(edit.base_revision());
  for (const console::CellEdit& cell : edit.cells()) {
    auto& to = message.edits().emplace_back();
    to.cell(ToCellMessage(cell.cell()));
    to.wall(cell.wall());
  }
}

void Write(const console::Guide& guide, Message& message) {
  message.kind(conav_msgs::msg::OPERATOR_REQUEST_GUIDE);
  message.robot(guide.robot());
  for (const console::Cell& cell : guide.path()) message.path().push_back(ToCellMessage(cell));
  message.answers_snapshot(guide.answers_snapshot());
  message.valid_for(guide.valid_for());
}

std::string Write(const console::Drive& drive, Message& message) {
  constexpr double kLatest = std::numeric_limits<std::int32_t>::max();
  if (!(drive.expires_at() >= 0.0 && drive.expires_at() <= kLatest)) {
    return fmt::format("expires_at = {} is not in [0, {}]", drive.expires_at(), kLatest);
  }
  if (!console::DriveAction_IsValid(drive.action())) {
    return fmt::format("action = {} is unknown", static_cast<int>(drive.action()));
  }
  message.kind(conav_msgs::msg::OPERATOR_REQUEST_DRIVE);
  message.robot(drive.robot());
  message.drive(static_cast<std::uint8_t>(drive.action()));
  message.expires_at(ToMessage(SimTime::FromSeconds(drive.expires_at())));
  return "";
}

std::string Write(const console::Select& select, Message& message) {
  if (!console::AttentionReason_IsValid(select.reason())) {
    return fmt::format("reason = {} is unknown", static_cast<int>(select.reason()));
  }
  message.kind(conav_msgs::msg::OPERATOR_REQUEST_SELECT);
  message.robot(select.robot());
  message.attention_reason(static_cast<std::uint8_t>(select.reason()));
  return "";
}

void Write(const console::Answer& answer, Message& message) {
  message.kind(conav_msgs::msg::OPERATOR_REQUEST_ANSWER);
  message.robot(answer.robot());
  message.answers_snapshot(answer.snapshot());
}

/// Whom a request is about, where it may be several robots.
template <class Body>
void WriteRobots(std::uint8_t kind, const Body& body, Message& message) {
  message.kind(kind);
  message.robots().assign(body.robots().begin(), body.robots().end());
}

/// What cannot even be written down in the message; empty otherwise.
std::string WriteBody(const console::Request& request, Message& message) {
  switch (request.body_case()) {
    case console::Request::kEdit:
      Write(request.edit(), message);
      return "";
    case console::Request::kGuide:
      Write(request.guide(), message);
      return "";
    case console::Request::kDrive:
      return Write(request.drive(), message);
    case console::Request::kSelect:
      return Write(request.select(), message);
    case console::Request::kAnswer:
      Write(request.answer(), message);
      return "";
    case console::Request::kStop:
      WriteRobots(conav_msgs::msg::OPERATOR_REQUEST_STOP, request.stop(), message);
      message.reason(request.stop().reason());
      return "";
    case console::Request::kGo:
      WriteRobots(conav_msgs::msg::OPERATOR_REQUEST_GO, request.go(), message);
      return "";
    case console::Request::kTakeControl:
      WriteRobots(conav_msgs::msg::OPERATOR_REQUEST_TAKE_CONTROL, request.take_control(), message);
      message.reason(request.take_control().reason());
      return "";
    case console::Request::kReleaseControl:
      WriteRobots(conav_msgs::msg::OPERATOR_REQUEST_RELEASE_CONTROL, request.release_control(),
                  message);
      return "";
    case console::Request::kAcknowledge:
      message.kind(conav_msgs::msg::OPERATOR_REQUEST_ACKNOWLEDGE);
      message.alert(request.acknowledge().alert());
      return "";
    case console::Request::kShelve:
      message.kind(conav_msgs::msg::OPERATOR_REQUEST_SHELVE);
      message.alert(request.shelve().alert());
      message.duration(request.shelve().duration());
      return "";
    case console::Request::kFinish:
      message.kind(conav_msgs::msg::OPERATOR_REQUEST_FINISH);
      return "";
    case console::Request::BODY_NOT_SET:
      return "the request asks for nothing that is known here";
  }
  return "the request asks for nothing that is known here";
}

}  // namespace

Result<OperatorRequest> ToOperatorRequest(const console::Request& request,
                                          const std::string& client, SimTime now) {
  Message message;
  message.header().stamp(ToMessage(now));
  message.header().frame_id("map");
  message.client(client);
  message.request_id(request.id());
  message.world(request.world());
  const std::string unwritable = WriteBody(request, message);
  if (!unwritable.empty()) return Fail(ErrorCode::kMalformed, unwritable);
  return ToDomain(message);
}

std::string CheckNow(const PageIdentity& who, const PageAsked& asked, double wall_s,
                     double drive_limit_s) {
  const console::Request& request = asked.request;
  if (who.role == console::ROLE_OBSERVER && !request.has_stop()) {
    return "an observer looks on, and may stop robots only";
  }
  const double late = wall_s - request.valid_until();
  if (!(late <= 0.0)) return fmt::format("it came {:.1f} s too late", late);
  const bool drives = request.has_drive() && request.drive().action() != console::DRIVE_STOP;
  if (drives && asked.round_trip_s > drive_limit_s) {
    return fmt::format("the round trip takes {:.1f} s, longer than {:.1f} s: too long to drive",
                       asked.round_trip_s, drive_limit_s);
  }
  return "";
}

}  // namespace conav::operators
