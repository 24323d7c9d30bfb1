#include "operator/gateway/convert_request.h"

#include <fmt/format.h>

#include <limits>
#include <utility>

namespace conav::operators {
namespace {

using Body = decltype(OperatorRequest::body);
using Names = google::protobuf::RepeatedPtrField<std::string>;

Cell ToCell(const console::Cell& cell) { return {cell.row(), cell.column()}; }

std::vector<std::string> ToNames(const Names& names) { return {names.begin(), names.end()}; }

EditRequest ToDomain(const console::Edit& edit) {
  EditRequest request{edit.base_revision(), {}};
  request.edits.reserve(static_cast<std::size_t>(edit.cells_size()));
  for (const console::CellEdit& one : edit.cells()) {
    request.edits.push_back({ToCell(one.cell()), one.wall()});
  }
  return request;
}

GuideRequest ToDomain(const console::Guide& guide) {
  GuideRequest request{guide.robot(), {}, guide.answers_snapshot(), guide.valid_for()};
  request.path.reserve(static_cast<std::size_t>(guide.path_size()));
  for (const console::Cell& cell : guide.path()) request.path.push_back(ToCell(cell));
  return request;
}

/// Times and enumerators that the domain's types cannot hold are refused here.
Result<Body> ToDomain(const console::Drive& drive) {
  constexpr double kLatest = std::numeric_limits<std::int32_t>::max();
  if (!(drive.expires_at() >= 0.0 && drive.expires_at() <= kLatest)) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("expires_at = {} is not in [0, {}]", drive.expires_at(), kLatest));
  }
  if (!console::DriveAction_IsValid(drive.action())) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("action = {} is unknown", static_cast<int>(drive.action())));
  }
  return DriveRequest{drive.robot(), static_cast<DriveAction>(drive.action()),
                      SimTime::FromSeconds(drive.expires_at())};
}

Result<Body> ToDomain(const console::Select& select) {
  if (!console::AttentionReason_IsValid(select.reason())) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("reason = {} is unknown", static_cast<int>(select.reason())));
  }
  return SelectRequest{select.robot(), static_cast<AttentionReason>(select.reason())};
}

Result<Body> ToBody(const console::Request& request) {
  switch (request.body_case()) {
    case console::Request::kEdit:
      return ToDomain(request.edit());
    case console::Request::kGuide:
      return ToDomain(request.guide());
    case console::Request::kDrive:
      return ToDomain(request.drive());
    case console::Request::kSelect:
      return ToDomain(request.select());
    case console::Request::kAnswer:
      return AnswerRequest{request.answer().robot(), request.answer().snapshot()};
    case console::Request::kStop:
      return StopRequest{ToNames(request.stop().robots()), request.stop().reason()};
    case console::Request::kGo:
      return GoRequest{ToNames(request.go().robots())};
    case console::Request::kTakeControl:
      return TakeControlRequest{ToNames(request.take_control().robots()),
                                request.take_control().reason()};
    case console::Request::kReleaseControl:
      return ReleaseControlRequest{ToNames(request.release_control().robots())};
    case console::Request::kAcknowledge:
      return AcknowledgeRequest{request.acknowledge().alert()};
    case console::Request::kShelve:
      return ShelveRequest{request.shelve().alert(), request.shelve().duration()};
    case console::Request::kFinish:
      return FinishRequest{};
    case console::Request::BODY_NOT_SET:
      break;
  }
  return Fail(ErrorCode::kMalformed, "the request asks for nothing that is known here");
}

}  // namespace

Result<OperatorRequest> ToOperatorRequest(const console::Request& request,
                                          const std::string& client, SimTime now) {
  return ToBody(request).and_then([&](Body&& body) {
    return Checked({now, client, request.id(), request.world(), std::move(body)});
  });
}

std::string CheckNow(const PageIdentity& who, const PageAsked& asked, double wall_s,
                     double drive_limit_s) {
  const console::Request& request = asked.request;
  if (who.role == console::ROLE_OBSERVER && !request.has_stop()) {
    return "an observer may only watch and stop robots";
  }
  const double late = wall_s - request.valid_until();
  if (!(late <= 0.0)) return fmt::format("it arrived {:.1f} s too late", late);
  const bool drives = request.has_drive() && request.drive().action() != console::DRIVE_STOP;
  if (drives && asked.round_trip_s > drive_limit_s) {
    return fmt::format("the round trip takes {:.1f} s, longer than {:.1f} s: too long to drive",
                       asked.round_trip_s, drive_limit_s);
  }
  return "";
}

}  // namespace conav::operators
