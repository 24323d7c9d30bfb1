#include "operator/console/console_messages.h"

#include <fmt/core.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/wire_format_lite.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "common/msg/method.h"

namespace conav::operators {
namespace {

using google::protobuf::internal::WireFormatLite;
using google::protobuf::io::CodedOutputStream;
using google::protobuf::io::StringOutputStream;

constexpr std::size_t kLongest = 10000;

/// Tag and length of a message in field `field`.
void WriteHead(CodedOutputStream& out, int field, std::size_t length) {
  out.WriteTag(WireFormatLite::MakeTag(field, WireFormatLite::WIRETYPE_LENGTH_DELIMITED));
  out.WriteVarint32(static_cast<std::uint32_t>(length));
}

console::Cells CellsOf(std::span<const Cell> cells) {
  console::Cells message;
  for (const Cell cell : cells) {
    message.add_row(cell.row);
    message.add_column(cell.column);
  }
  return message;
}

}  // namespace

std::optional<Cell> CellAt(Position position, const GridGeometry& grid) {
  const double limit_m = (grid.rows + grid.columns) * grid.cell_size_m;  // far away has no cell
  if (!(std::abs(position.x_m - grid.middle.x_m) < limit_m &&
        std::abs(position.y_m - grid.middle.y_m) < limit_m)) {
    return std::nullopt;
  }
  const Cell cell = grid.PositionToCell(position);
  return grid.Contains(cell) ? std::optional(cell) : std::nullopt;
}

std::vector<Cell> CellsAt(std::span<const Position> positions, const GridGeometry& grid) {
  std::vector<Cell> cells;
  for (const Position position : positions) {
    const auto cell = CellAt(position, grid);
    if (!cell || cells.size() == kLongest) break;
    cells.push_back(*cell);
  }
  return cells;
}

std::string EncodeUpdate(const console::Update& update) {
  std::string encoded;
  StringOutputStream stream(&encoded);
  CodedOutputStream out(&stream);
  WriteHead(out, console::Updates::kUpdateFieldNumber, update.ByteSizeLong());
  update.SerializeWithCachedSizes(&out);
  out.Trim();
  return encoded;
}

std::string EncodeUpdates(std::string_view updates, bool everything) {
  console::Updates flags;
  flags.set_everything(everything);
  const std::string flag_bytes = flags.SerializeAsString();
  std::string encoded;
  StringOutputStream stream(&encoded);
  CodedOutputStream out(&stream);
  WriteHead(out, console::ServerMessage::kUpdatesFieldNumber, updates.size() + flag_bytes.size());
  out.WriteRaw(updates.data(), static_cast<int>(updates.size()));
  out.WriteRaw(flag_bytes.data(), static_cast<int>(flag_bytes.size()));
  out.Trim();
  return encoded;
}

std::string Encode(const console::ServerMessage& message) { return message.SerializeAsString(); }

Result<console::ClientMessage> DecodeClientMessage(std::string_view bytes) {
  console::ClientMessage message;
  if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    return Fail(ErrorCode::kMalformed,
                "a message of " + std::to_string(bytes.size()) + " bytes is no ClientMessage");
  }
  if (message.body_case() == console::ClientMessage::BODY_NOT_SET) {
    return Fail(ErrorCode::kMalformed, "a ClientMessage without a body");
  }
  return message;
}

void SetMethod(const std::string& method, console::Session& session) {
  const auto kind = ParseMethod(method);
  session.set_method(method);
  session.set_drives(kind == MethodKind::kTeleop);
  session.set_streams(kind && NeedsLiveView(*kind));
}

console::Session SessionOf(const std::vector<std::string>& robots, const std::string& method) {
  console::Session session;
  std::set<std::string> worlds;
  for (const std::string& entry : robots) {
    const auto slash = entry.find('/');
    worlds.insert(entry.substr(0, slash));
    session.add_robots(entry.substr(slash + 1));
  }
  for (const std::string& world : worlds) session.add_worlds(world);
  SetMethod(method, session);
  return session;
}

console::Cell ToConsole(Cell cell) {
  console::Cell message;
  message.set_row(cell.row);
  message.set_column(cell.column);
  return message;
}

void AddCells(std::span<const Cell> cells, google::protobuf::RepeatedPtrField<console::Cell>* to) {
  to->Reserve(static_cast<int>(cells.size()));
  for (const Cell cell : cells) *to->Add() = ToConsole(cell);
}

console::Robot ToConsole(const RobotState& state, double received_s) {
  console::Robot robot;
  robot.set_name(state.robot);
  robot.set_world(state.world);
  robot.set_camera_bytes(state.camera_bytes);
  robot.set_stamp(state.stamp.ToSeconds());
  robot.set_received_at(received_s);
  *robot.mutable_cell() = ToConsole(state.cell);
  robot.set_x(state.position.x_m);
  robot.set_y(state.position.y_m);
  robot.set_heading(state.heading_rad);
  AddCells(state.goals_left, robot.mutable_goals_left());
  AddCells(state.goals_reached, robot.mutable_goals_reached());
  robot.set_goals_total(state.goals_total);
  robot.set_outcome(static_cast<console::CommandOutcome>(state.command_outcome));
  robot.set_detail(state.command_detail);
  robot.set_stopped(state.stopped);
  robot.set_keeps_goals(state.goals_stamp != SimTime{});
  robot.set_cell_moves(state.cell_moves);
  robot.set_low_level_steps(state.low_level_steps);
  robot.set_images(state.images);
  return robot;
}

namespace {

/// `cells`: row-major.
std::string Pack(const std::string& cells, int columns) {
  const auto width = static_cast<std::size_t>(columns);
  const auto difference = [&](std::size_t i) {
    return static_cast<char>(i < width ? cells[i] : cells[i] ^ cells[i - width]);
  };
  std::string packed;
  StringOutputStream stream(&packed);
  CodedOutputStream out(&stream);
  out.WriteVarint32(static_cast<std::uint32_t>(columns));
  for (std::size_t begin = 0; begin < cells.size();) {
    const char value = difference(begin);
    std::size_t end = begin + 1;
    while (end < cells.size() && difference(end) == value) ++end;
    out.WriteVarint32(static_cast<std::uint32_t>(end - begin));
    out.WriteRaw(&value, 1);
    begin = end;
  }
  out.Trim();
  return packed;
}

}  // namespace

std::string Packed(const Grid<float>& probabilities) {
  std::string bytes;
  bytes.reserve(probabilities.size());
  for (const float p : probabilities.values()) {
    bytes.push_back(static_cast<char>(std::lround(255.0F * std::clamp(p, 0.0F, 1.0F))));
  }
  return Pack(bytes, probabilities.columns());
}

std::string Packed(const OccupancyGrid& cells) {
  std::string bytes;
  bytes.reserve(cells.size());
  for (const Occupancy cell : cells.values()) bytes.push_back(static_cast<char>(cell));
  return Pack(bytes, cells.columns());
}

console::Guidance ToConsole(const Guidance& guidance) {
  console::Guidance message;
  message.set_robot(guidance.robot);
  message.set_world(guidance.world);
  message.set_revision(guidance.revision);
  AddCells(guidance.path, message.mutable_path());
  message.set_given_by(guidance.given_by);
  message.set_answers_snapshot(guidance.answers_snapshot);
  message.set_stamp(guidance.stamp.ToSeconds());
  message.set_valid_until(guidance.valid_until.ToSeconds());
  return message;
}

console::Snapshot ToConsole(const Snapshot& snapshot, double received_s) {
  console::Snapshot message;
  message.set_robot(snapshot.robot);
  message.set_world(snapshot.world);
  message.set_sequence_number(snapshot.sequence_number);
  message.set_stamp(snapshot.stamp.ToSeconds());
  message.set_received_at(received_s);
  *message.mutable_cell() = ToConsole(snapshot.cell);
  message.set_heading(snapshot.heading_rad);
  message.set_field_of_view(snapshot.horizontal_fov_rad);
  message.set_width(snapshot.width);
  message.set_height(snapshot.height);
  message.set_bytes(static_cast<std::uint32_t>(snapshot.jpeg.size()));
  *message.mutable_free_cells() = CellsOf(snapshot.visible.free);
  *message.mutable_wall_cells() = CellsOf(snapshot.visible.walls);
  AddCells(snapshot.path, message.mutable_path());
  return message;
}

console::Search ToConsole(const SearchReport& report) {
  console::Search message;
  message.set_robot(report.robot);
  message.set_stamp(report.stamp.ToSeconds());
  message.set_decision(report.decision);
  *message.mutable_cell() = ToConsole(report.cell);
  message.set_method(report.method);
  for (const SearchAction& action : report.actions) {
    console::SearchAction* to = message.add_actions();
    to->set_snapshot(action.kind == CommandKind::kTransmitView);
    *to->mutable_target() = ToConsole(action.target);
    to->set_heading(action.heading_rad);
    to->set_visits(action.visits);
  }
  message.set_chosen(report.chosen);
  message.set_duration_ms(report.duration_ms);
  return message;
}

console::Alert ToConsole(const Alert& alert) {
  console::Alert message;
  message.set_id(alert.id);
  message.set_severity(static_cast<console::Severity>(alert.condition.severity));
  message.set_source(alert.condition.source);
  message.set_text(alert.condition.text);
  message.set_advice(alert.condition.advice);
  message.set_raised(alert.raised_s);
  message.set_newest(alert.newest_s);
  message.set_count(alert.count);
  message.set_active(alert.active);
  message.set_acknowledged_by(alert.acknowledged_by);
  message.set_acknowledged(alert.acknowledged_s);
  message.set_shelved_until(alert.shelved_until_s);
  return message;
}

namespace {

console::AttentionItem ToConsole(const AttentionItem& item) {
  console::AttentionItem message;
  message.set_world(item.world);
  message.set_robot(item.robot);
  message.set_reason(static_cast<console::AttentionReason>(item.reason));
  message.set_since(item.since.ToSeconds());
  message.set_deadline(item.deadline.ToSeconds());
  message.set_gives_up_after(item.gives_up_after_s);
  *message.mutable_cell() = operators::ToConsole(item.cell);
  message.set_newest_snapshot(item.newest_snapshot);
  message.set_value_lost_per_second(item.value_lost_per_s);
  message.set_expected_interaction(item.expected_interaction_s);
  message.set_selected_by(item.selected_by);
  return message;
}

}  // namespace

console::Attention ToConsole(const AttentionQueueState& queue) {
  console::Attention message;
  message.set_stamp(queue.stamp.ToSeconds());
  message.set_order(queue.order);
  for (const AttentionItem& item : queue.items) *message.add_items() = ToConsole(item);
  const OperatorWorkload& workload = queue.workload;
  message.set_robots(workload.robots);
  message.set_observed(workload.observed_s);
  message.set_busy(workload.busy_s);
  message.set_interaction_time(workload.interaction_time_s);
  message.set_neglect_time(workload.neglect_time_s);
  message.set_utilisation(workload.utilisation);
  message.set_fan_out(workload.fan_out);
  message.set_attended_robots(workload.attended_robots);
  message.set_predicted_waiting_time(workload.predicted_waiting_time_s);
  return message;
}

namespace {

console::EventKind KindOf(const OperatorEvent& event) {
  if (!event.accepted) return console::EVENT_REFUSED;
  switch (event.kind) {
    case RequestKind::kEdit:
      return console::EVENT_EDIT;
    case RequestKind::kGuide:
      return console::EVENT_GUIDE;
    case RequestKind::kAnswer:
      return console::EVENT_ANSWER;
    case RequestKind::kStop:
      return console::EVENT_STOP;
    case RequestKind::kResume:
      return console::EVENT_RESUME;
    case RequestKind::kTakeControl:
      return console::EVENT_TAKE_CONTROL;
    case RequestKind::kReleaseControl:
      return console::EVENT_RELEASE_CONTROL;
    case RequestKind::kFinish:
      return console::EVENT_FINISH;
    case RequestKind::kGoals:
      return console::EVENT_GOALS;
    case RequestKind::kNote:
      return console::EVENT_NOTE;
    case RequestKind::kDrive:
    case RequestKind::kSelect:
    case RequestKind::kAcknowledge:
    case RequestKind::kShelve:
      break;
  }
  return console::EVENT_NONE;
}

/// A Cell with two numbers of two bytes (maps have up to 2048 rows and columns), its tag and
/// length; a CellEdit with one of these and `wall`, its tag and length.
constexpr std::size_t kPathCellBytes = 8;
constexpr std::size_t kEditCellBytes = 12;
/// The rest of a request: names, numbers, the messages around.
constexpr std::size_t kOtherBytes = 512;

std::uint32_t Fitting(std::size_t message_bytes, std::size_t cell_bytes, std::uint32_t most) {
  const std::size_t room = std::max(message_bytes, kOtherBytes) - kOtherBytes;
  return static_cast<std::uint32_t>(std::min<std::size_t>(room / cell_bytes, most));
}

}  // namespace

console::Event ToConsole(const OperatorEvent& event, double time_s) {
  console::Event message;
  message.set_kind(KindOf(event));
  message.set_time(time_s);
  message.set_stamp(event.stamp.ToSeconds());
  message.set_client(event.client);
  message.set_world(event.world);
  message.set_robot(event.robot);
  message.set_text(event.text);
  message.set_revision(event.revision);
  return message;
}

RequestLimits LimitsOf(std::size_t message_bytes, RequestLimits most) {
  return {Fitting(message_bytes, kEditCellBytes, most.edit_cells),
          Fitting(message_bytes, kPathCellBytes, most.path_cells)};
}

namespace {

using Body = decltype(OperatorRequest::body);
using NameField = google::protobuf::RepeatedPtrField<std::string>;

Cell ToCell(const console::Cell& cell) { return {cell.row(), cell.column()}; }

std::vector<std::string> ToNames(const NameField& names) { return {names.begin(), names.end()}; }

EditRequest ToRequest(const console::Edit& edit) {
  EditRequest request{edit.base_revision(), {}};
  request.edits.reserve(static_cast<std::size_t>(edit.cells_size()));
  for (const console::CellEdit& one : edit.cells()) {
    request.edits.push_back({ToCell(one.cell()), one.wall()});
  }
  return request;
}

GuideRequest ToRequest(const console::Guide& guide) {
  GuideRequest request{guide.robot(), {}, guide.answers_snapshot(), guide.valid_for()};
  request.path.reserve(static_cast<std::size_t>(guide.path_size()));
  for (const console::Cell& cell : guide.path()) request.path.push_back(ToCell(cell));
  return request;
}

/// Times and enumerators that the domain's types cannot hold are refused here.
Result<Body> ToRequest(const console::Drive& drive) {
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

Result<Body> ToRequest(const console::Select& select) {
  if (!console::AttentionReason_IsValid(select.reason())) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("reason = {} is unknown", static_cast<int>(select.reason())));
  }
  return SelectRequest{select.robot(), static_cast<AttentionReason>(select.reason())};
}

std::vector<Position> ToPlaces(const google::protobuf::RepeatedPtrField<console::Place>& message) {
  std::vector<Position> places;
  places.reserve(static_cast<std::size_t>(message.size()));
  for (const console::Place& place : message) places.push_back({place.x(), place.y()});
  return places;
}

Result<Body> ToBody(const console::Request& request) {
  switch (request.body_case()) {
    case console::Request::kEdit:
      return ToRequest(request.edit());
    case console::Request::kGuide:
      return ToRequest(request.guide());
    case console::Request::kDrive:
      return ToRequest(request.drive());
    case console::Request::kSelect:
      return ToRequest(request.select());
    case console::Request::kAnswer:
      return AnswerRequest{request.answer().robot(), request.answer().snapshot()};
    case console::Request::kStop:
      return StopRequest{ToNames(request.stop().robots()), request.stop().reason()};
    case console::Request::kResume:
      return ResumeRequest{ToNames(request.resume().robots())};
    case console::Request::kTakeControl:
      return TakeControlRequest{ToNames(request.take_control().robots()),
                                request.take_control().reason(), request.take_control().ask()};
    case console::Request::kReleaseControl:
      return ReleaseControlRequest{ToNames(request.release_control().robots()),
                                   request.release_control().to_client()};
    case console::Request::kAcknowledge:
      return AcknowledgeRequest{request.acknowledge().alert()};
    case console::Request::kShelve:
      return ShelveRequest{request.shelve().alert(), request.shelve().duration()};
    case console::Request::kFinish:
      return FinishRequest{};
    case console::Request::kGoals:
      return GoalsRequest{request.goals().robot(), ToPlaces(request.goals().add()),
                          ToPlaces(request.goals().remove())};
    case console::Request::kNote:
      return NoteRequest{request.note().text()};
    case console::Request::kBegin:  // a StudyRequest, like those below
    case console::Request::kAnswers:
    case console::Request::kDraft:
    case console::Request::kPause:
    case console::Request::kAbort:
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

}  // namespace conav::operators
