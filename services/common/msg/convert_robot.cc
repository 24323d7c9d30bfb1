#include <numbers>

#include "common/msg/convert.h"
#include "common/msg/convert_checks.h"

namespace conav {

using convert::Checks;
using convert::ToCellMessage;
using convert::ToCellMessages;

Result<RobotCommand> ToDomain(const conav_msgs::msg::RobotCommand& message) {
  Checks checks;
  RobotCommand command;
  command.stamp = checks.Stamp(message.header());
  command.robot = checks.Name("robot", message.robot());
  command.sequence_number = message.sequence_number();
  command.lease_epoch = message.lease_epoch();
  command.expires_at = checks.Time("expires_at", message.expires_at());
  command.kind = checks.Enumerator("kind", message.kind(), CommandKind::kStop, CommandKind::kDrive);
  command.target = checks.ToCell("target", message.target());
  command.heading_rad = checks.Heading("heading", message.heading());
  command.drive =
      checks.Enumerator("drive", message.drive(), DriveAction::kStop, DriveAction::kTurnRight);
  command.drive_order = message.drive_order();
  if (checks.failed()) return checks.failure();
  return command;
}

conav_msgs::msg::RobotCommand ToMessage(const RobotCommand& command) {
  conav_msgs::msg::RobotCommand message;
  message.header(ToHeader(command.stamp));
  message.robot(command.robot);
  message.sequence_number(command.sequence_number);
  message.lease_epoch(command.lease_epoch);
  message.expires_at(ToMessage(command.expires_at));
  message.kind(static_cast<std::uint8_t>(command.kind));
  message.target(ToCellMessage(command.target));
  message.heading(command.heading_rad);
  message.drive(static_cast<std::uint8_t>(command.drive));
  message.drive_order(command.drive_order);
  return message;
}

Result<RobotState> ToDomain(const conav_msgs::msg::RobotState& message) {
  Checks checks;
  RobotState state;
  state.stamp = checks.Stamp(message.header());
  state.world = checks.Name("world", message.world());
  state.robot = checks.Name("robot", message.robot());
  state.cell = checks.ToCell("cell", message.cell());
  state.heading_rad = checks.Heading("heading", message.heading());
  state.position.x_m = checks.Finite("position.x", message.position().x());
  state.position.y_m = checks.Finite("position.y", message.position().y());
  state.goals_left = checks.Cells("goals_left", message.goals_left());
  state.goals_reached = checks.Cells("goals_reached", message.goals_reached());
  state.goals_total = message.goals_total();
  state.path = checks.Cells("path", message.path());
  state.command_sequence_number = message.command_sequence_number();
  state.command_outcome = checks.Enumerator("command_outcome", message.command_outcome(),
                                            CommandOutcome::kNone, CommandOutcome::kExpired);
  state.command_detail = checks.Text("command_detail", message.command_detail());
  state.command_cell = checks.ToCell("command_cell", message.command_cell());
  state.drive_order = message.drive_order();
  state.lease_epoch = message.lease_epoch();
  state.cell_moves = message.cell_moves();
  state.low_level_steps = message.low_level_steps();
  state.images = message.images();
  state.image_bytes = message.image_bytes();
  state.snapshots = message.snapshots();
  state.map_stamp = checks.Time("map_stamp", message.map_stamp());
  if (state.goals_left.size() + state.goals_reached.size() > state.goals_total) {
    checks.Refuse(fmt::format("goals_total = {} is below goals_left + goals_reached = {}",
                              state.goals_total,
                              state.goals_left.size() + state.goals_reached.size()));
  }
  if (checks.failed()) return checks.failure();
  return state;
}

conav_msgs::msg::RobotState ToMessage(const RobotState& state) {
  conav_msgs::msg::RobotState message;
  message.header(ToHeader(state.stamp));
  message.world(state.world);
  message.robot(state.robot);
  message.cell(ToCellMessage(state.cell));
  message.heading(state.heading_rad);
  message.position().x(state.position.x_m);
  message.position().y(state.position.y_m);
  message.goals_left(ToCellMessages(state.goals_left));
  message.goals_reached(ToCellMessages(state.goals_reached));
  message.goals_total(state.goals_total);
  message.path(ToCellMessages(state.path));
  message.command_sequence_number(state.command_sequence_number);
  message.command_outcome(static_cast<std::uint8_t>(state.command_outcome));
  message.command_detail(state.command_detail);
  message.command_cell(ToCellMessage(state.command_cell));
  message.drive_order(state.drive_order);
  message.lease_epoch(state.lease_epoch);
  message.cell_moves(state.cell_moves);
  message.low_level_steps(state.low_level_steps);
  message.images(state.images);
  message.image_bytes(state.image_bytes);
  message.snapshots(state.snapshots);
  message.map_stamp(ToMessage(state.map_stamp));
  return message;
}

namespace {

/// Checks format, size and pixels; decoding the image is up to its users.
void CheckImage(Checks& checks, const conav_msgs::msg::Snapshot& message) {
  checks.Size("data", message.data().size(), convert::kMaxJpegBytes);
  checks.Range("width", message.width(), 0, convert::kMaxImageSide);
  checks.Range("height", message.height(), 0, convert::kMaxImageSide);
  const bool empty = message.data().empty();
  if (message.format() == "jpeg" && empty) checks.Refuse("data is empty in format 'jpeg'");
  if (message.format() == "none" && !empty) {
    checks.Refuse(fmt::format("data has size {} in format 'none'", message.data().size()));
  }
  if (message.format() != "jpeg" && message.format() != "none") {
    checks.Refuse(
        fmt::format("format = '{}' is not 'jpeg' or 'none'", message.format().substr(0, 40)));
  }
}

}  // namespace

Result<Snapshot> ToDomain(conav_msgs::msg::Snapshot message) {
  Checks checks;
  CheckImage(checks, message);
  if (checks.failed()) return checks.failure();
  Snapshot snapshot;
  snapshot.stamp = checks.Stamp(message.header());
  snapshot.world = checks.Name("world", message.world());
  snapshot.robot = checks.Name("robot", message.robot());
  snapshot.sequence_number = message.sequence_number();
  if (snapshot.sequence_number == 0) checks.Refuse("sequence_number = 0 is below 1");
  snapshot.streamed = message.streamed();
  snapshot.cell = checks.ToCell("cell", message.cell());
  snapshot.heading_rad = checks.Heading("heading", message.heading());
  snapshot.horizontal_fov_rad = checks.Range(
      "horizontal_field_of_view", message.horizontal_field_of_view(), 0.0, 2.0 * std::numbers::pi);
  snapshot.width = message.width();
  snapshot.height = message.height();
  snapshot.jpeg = std::move(message.data());
  snapshot.visible = checks.Visible("", message.free_cells(), message.wall_cells());
  snapshot.path = checks.Cells("path", message.path());
  snapshot.goals_left = checks.Cells("goals_left", message.goals_left());
  if (checks.failed()) return checks.failure();
  return snapshot;
}

conav_msgs::msg::Snapshot ToMessage(const Snapshot& snapshot) {
  conav_msgs::msg::Snapshot message;
  message.header(ToHeader(snapshot.stamp));
  message.world(snapshot.world);
  message.robot(snapshot.robot);
  message.sequence_number(snapshot.sequence_number);
  message.streamed(snapshot.streamed);
  message.cell(ToCellMessage(snapshot.cell));
  message.heading(snapshot.heading_rad);
  message.horizontal_field_of_view(snapshot.horizontal_fov_rad);
  message.width(snapshot.width);
  message.height(snapshot.height);
  message.format(snapshot.jpeg.empty() ? "none" : "jpeg");
  message.data(snapshot.jpeg);
  message.free_cells(ToCellMessages(snapshot.visible.free));
  message.wall_cells(ToCellMessages(snapshot.visible.walls));
  message.path(ToCellMessages(snapshot.path));
  message.goals_left(ToCellMessages(snapshot.goals_left));
  return message;
}

}  // namespace conav
