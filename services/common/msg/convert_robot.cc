#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <utility>

#include "common/msg/convert.h"
#include "common/msg/convert_checks.h"

namespace conav {

using convert::Checks;
using convert::ToPoints;
using convert::ToPoses;
using convert::WriteAddress;

namespace {

constexpr double kMaxTolerance = 1000.0;  // metres
constexpr double kMaxDistance = 1.0e9;    // metres

/// The cell of the newest place; of the pose where there is no place yet.
Cell CellOf(Checks& checks, const std::vector<Cell>& path, Position position,
            const GridGeometry& grid) {
  if (!path.empty() || checks.failed()) return path.empty() ? Cell{} : path.back();
  const Cell cell = grid.PositionToCell(position);
  checks.Inside("pose.position", cell, static_cast<std::uint32_t>(grid.rows),
                static_cast<std::uint32_t>(grid.columns));
  return cell;
}

}  // namespace

Result<RobotCommand> ToDomain(const conav_msgs::msg::RobotCommand& message) {
  Checks checks;
  RobotCommand command;
  command.stamp = checks.Stamp(message.header());
  command.robot = checks.Name("robot", message.robot());
  command.sequence_number = message.sequence_number();
  command.lease_epoch = message.lease_epoch();
  command.expires_at = checks.Time("expires_at", message.expires_at());
  command.kind = checks.Enumerator("kind", message.kind(), CommandKind::kStop, CommandKind::kDrive);
  command.path = checks.Places("path", message.path());
  command.tolerance_m = checks.Range("tolerance", message.tolerance(), 0.0, kMaxTolerance);
  if (command.kind == CommandKind::kMove && command.path.empty()) {
    checks.Refuse("path is empty: a move needs a destination");
  }
  if (!checks.failed() && !command.path.empty()) {
    command.arrival_heading_rad =
        checks.Yaw("path.back().orientation", message.path().back().orientation());
  }
  command.heading_rad = checks.Heading("heading", message.heading());
  command.drive =
      checks.Enumerator("drive", message.drive(), DriveAction::kStop, DriveAction::kTurnRight);
  command.drive_order = message.drive_order();
  return checks.OrFailure(std::move(command));
}

conav_msgs::msg::RobotCommand ToMessage(const RobotCommand& command) {
  conav_msgs::msg::RobotCommand message;
  message.header(ToHeader(command.stamp));
  message.robot(command.robot);
  message.sequence_number(command.sequence_number);
  message.lease_epoch(command.lease_epoch);
  message.expires_at(ToMessage(command.expires_at));
  message.kind(static_cast<std::uint8_t>(command.kind));
  message.path(ToPoses(command.path));
  if (!command.path.empty() && command.arrival_heading_rad) {
    message.path().back().orientation(ToQuaternion(*command.arrival_heading_rad));
  }
  message.tolerance(command.tolerance_m);
  message.heading(command.heading_rad);
  message.drive(static_cast<std::uint8_t>(command.drive));
  message.drive_order(command.drive_order);
  return message;
}

Result<RobotState> ToDomain(const conav_msgs::msg::RobotState& message) {
  Checks checks;
  RobotState state;
  checks.Address(message, state);
  state.grid = checks.Geometry("map_info", message.map_info());
  state.map_stamp = checks.Time("map_info.map_load_time", message.map_info().map_load_time());
  state.position = checks.Place("pose.position", message.pose().position());
  state.heading_rad = checks.Yaw("pose.orientation", message.pose().orientation()).value_or(0.0);
  state.speed_mps = checks.Finite("velocity.linear.x", message.velocity().linear().x());
  state.yaw_rate_rps = checks.Finite("velocity.angular.z", message.velocity().angular().z());
  state.goals_stamp = checks.Time("goals_stamp", message.goals_stamp());
  state.path = checks.CellsAt("path", message.path(), state.grid);
  state.cell = CellOf(checks, state.path, state.position, state.grid);
  state.command_sequence_number = message.command_sequence_number();
  state.command_outcome = checks.Enumerator("command_outcome", message.command_outcome(),
                                            CommandOutcome::kNone, CommandOutcome::kStopped);
  state.command_detail = checks.Text("command_detail", message.command_detail());
  state.command_cell =
      state.grid.PositionToCell(checks.Place("command_place", message.command_place()));
  state.drive_order = message.drive_order();
  state.lease_epoch = message.lease_epoch();
  state.cell_moves = message.moves();
  state.distance_m = checks.Range("distance", message.distance(), 0.0, kMaxDistance);
  state.low_level_steps = message.low_level_steps();
  state.images = message.images();
  state.image_bytes = message.image_bytes();
  state.camera_bytes = message.camera_bytes();
  state.snapshots = message.snapshots();
  state.stopped = message.stopped();
  state.stop_revision = message.stop_revision();
  return checks.OrFailure(std::move(state));
}

conav_msgs::msg::RobotState ToMessage(const RobotState& state) {
  conav_msgs::msg::RobotState message;
  WriteAddress(state, message);
  message.pose(convert::ToPoseMessage(state.position, state.heading_rad));
  message.velocity().linear().x(state.speed_mps);
  message.velocity().angular().z(state.yaw_rate_rps);
  message.map_info(convert::ToMapInfo(state.map_stamp, state.grid));
  message.goals_stamp(ToMessage(state.goals_stamp));
  message.path(ToPoints(state.path, state.grid));
  message.command_sequence_number(state.command_sequence_number);
  message.command_outcome(static_cast<std::uint8_t>(state.command_outcome));
  message.command_detail(state.command_detail);
  message.command_place(convert::ToPoint(state.grid.CellToPosition(state.command_cell)));
  message.drive_order(state.drive_order);
  message.lease_epoch(state.lease_epoch);
  message.moves(state.cell_moves);
  message.distance(state.distance_m);
  message.low_level_steps(state.low_level_steps);
  message.images(state.images);
  message.image_bytes(state.image_bytes);
  message.camera_bytes(state.camera_bytes);
  message.snapshots(state.snapshots);
  message.stopped(state.stopped);
  message.stop_revision(state.stop_revision);
  return message;
}

Result<RobotGoals> ToDomain(const conav_msgs::msg::RobotGoals& message) {
  Checks checks;
  RobotGoals goals;
  checks.Address(message, goals);
  goals.left = checks.Places("left", message.left());
  goals.reached = checks.Places("reached", message.reached());
  goals.total = message.total();
  goals.tolerance_m = checks.Range("tolerance", message.tolerance(), 0.0, kMaxTolerance);
  if (goals.left.size() + goals.reached.size() > goals.total) {
    checks.Refuse(fmt::format("total = {} is below left + reached = {}", goals.total,
                              goals.left.size() + goals.reached.size()));
  }
  return checks.OrFailure(std::move(goals));
}

conav_msgs::msg::RobotGoals ToMessage(const RobotGoals& goals) {
  conav_msgs::msg::RobotGoals message;
  WriteAddress(goals, message);
  message.left(ToPoses(goals.left));
  message.reached(ToPoses(goals.reached));
  message.total(goals.total);
  message.tolerance(goals.tolerance_m);
  return message;
}

namespace {

/// No JPEG has more, not even one of noise: a header, and 4 bytes a pixel.
constexpr std::size_t kJpegHeader = 64U << 10;
constexpr std::size_t kJpegPixel = 4;

/// Checks format, size and pixels; decoding the image is up to its users.
void CheckImage(Checks& checks, const conav_msgs::msg::Snapshot& message) {
  checks.Size("data", message.data().size(), convert::kMaxJpegBytes);
  checks.Range("width", message.width(), 0, convert::kMaxImageSide);
  checks.Range("height", message.height(), 0, convert::kMaxImageSide);
  const bool empty = message.data().empty();
  if (message.format() == "jpeg" && empty) checks.Refuse("data is empty in format 'jpeg'");
  const std::size_t most =
      kJpegHeader + kJpegPixel * static_cast<std::size_t>(message.width()) * message.height();
  if (message.format() == "jpeg" && message.data().size() > most) {
    checks.Refuse(fmt::format("data has {} bytes, more than {} x {} pixels can have",
                              message.data().size(), message.width(), message.height()));
  }
  const std::array<std::uint8_t, 3> begin{0xFF, 0xD8, 0xFF};
  if (message.format() == "jpeg" && !empty &&
      !std::ranges::equal(begin,
                          std::span(message.data())
                              .first(std::min<std::size_t>(begin.size(), message.data().size())))) {
    checks.Refuse("data does not begin like a JPEG");
  }
  if (message.format() == "none" && !empty) {
    checks.Refuse(fmt::format("data has size {} in format 'none'", message.data().size()));
  }
  if (message.format() != "jpeg" && message.format() != "none") {
    checks.Refuse(
        fmt::format("format = '{}' is not 'jpeg' or 'none'", message.format().substr(0, 40)));
  }
}

constexpr std::int8_t kShownFree = 0;
constexpr std::int8_t kShownWall = 100;
constexpr std::int8_t kNotShown = -1;

/// The piece of `grid` around `visible`, which may be empty.
nav_msgs::msg::OccupancyGrid ToView(SimTime stamp, const VisibleCells& visible,
                                    const GridGeometry& grid) {
  nav_msgs::msg::OccupancyGrid message;
  message.header(ToHeader(stamp));
  message.info(convert::ToMapInfo(stamp, grid));
  message.info().width(0);
  message.info().height(0);
  Cell low{grid.rows, grid.columns};
  Cell high{-1, -1};
  for (const auto* cells : {&visible.free, &visible.walls}) {
    for (const Cell cell : *cells) {
      low = {std::min(low.row, cell.row), std::min(low.column, cell.column)};
      high = {std::max(high.row, cell.row), std::max(high.column, cell.column)};
    }
  }
  if (high.row < 0) return message;
  const int width = high.column - low.column + 1;
  const int height = high.row - low.row + 1;
  const Position corner = grid.CellToPosition({high.row, low.column});
  message.info().width(static_cast<std::uint32_t>(width));
  message.info().height(static_cast<std::uint32_t>(height));
  message.info().origin().position().x(corner.x_m - grid.cell_size_m / 2.0);
  message.info().origin().position().y(corner.y_m - grid.cell_size_m / 2.0);
  message.data().assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                        kNotShown);
  const auto write = [&](const std::vector<Cell>& cells, std::int8_t value) {
    for (const Cell cell : cells) {
      const int index = (high.row - cell.row) * width + cell.column - low.column;
      message.data()[static_cast<std::size_t>(index)] = value;
    }
  };
  write(visible.free, kShownFree);
  write(visible.walls, kShownWall);
  return message;
}

/// The cells of `grid` that a view of its resolution shows.
VisibleCells ToVisible(Checks& checks, const nav_msgs::msg::OccupancyGrid& message,
                       const GridGeometry& grid) {
  constexpr double kTolerance = 0.01;  // cells
  VisibleCells visible;
  const auto& info = message.info();
  if (message.data().empty() || checks.failed()) return visible;
  checks.Shape(info.height(), info.width());
  if (message.data().size() != std::size_t{info.height()} * info.width()) {
    checks.Refuse(fmt::format("view.data has size {}, not {} x {}", message.data().size(),
                              info.height(), info.width()));
  }
  if (!(std::abs(static_cast<double>(info.resolution()) - grid.cell_size_m) <=
        kTolerance * grid.cell_size_m)) {
    checks.Refuse(fmt::format("view.info.resolution = {} is not that of the map, {}",
                              info.resolution(), grid.cell_size_m));
  }
  const Position corner = checks.Place("view.info.origin.position", info.origin().position());
  if (checks.failed()) return visible;
  const double half = grid.cell_size_m / 2.0;
  const Cell south_west = grid.PositionToCell({corner.x_m + half, corner.y_m + half});
  const auto rows = static_cast<std::uint32_t>(grid.rows);
  const auto columns = static_cast<std::uint32_t>(grid.columns);
  const int height = static_cast<int>(info.height());
  const int width = static_cast<int>(info.width());
  const Cell north_west = south_west + Cell{1 - height, 0};
  checks.Inside("view", std::array{north_west, south_west + Cell{0, width - 1}}, rows, columns);
  if (checks.failed()) return visible;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const int index = (height - 1 - row) * width + column;
      const std::int8_t value = message.data()[static_cast<std::size_t>(index)];
      if (value == kNotShown) continue;
      const Cell cell = north_west + Cell{row, column};
      if (value == kShownFree) visible.free.push_back(cell);
      if (value == kShownWall) visible.walls.push_back(cell);
      if (value != kShownFree && value != kShownWall) {
        checks.Refuse(fmt::format("view.data[{}] = {} is not -1, 0 or 100", index, value));
        return visible;
      }
    }
  }
  return visible;
}

}  // namespace

Result<Snapshot> ToDomain(conav_msgs::msg::Snapshot message) {
  Checks checks;
  CheckImage(checks, message);
  if (checks.failed()) return checks.failure();
  Snapshot snapshot;
  checks.Address(message, snapshot);
  snapshot.sequence_number = message.sequence_number();
  if (snapshot.sequence_number == 0) checks.Refuse("sequence_number = 0 is below 1");
  snapshot.streamed = message.streamed();
  snapshot.grid = checks.Geometry("map_info", message.map_info());
  snapshot.path = checks.CellsAt("path", message.path(), snapshot.grid);
  snapshot.position = checks.Place("pose.position", message.pose().position());
  snapshot.heading_rad = checks.Yaw("pose.orientation", message.pose().orientation()).value_or(0.0);
  snapshot.cell = CellOf(checks, snapshot.path, snapshot.position, snapshot.grid);
  snapshot.horizontal_fov_rad = checks.Range(
      "horizontal_field_of_view", message.horizontal_field_of_view(), 0.0, 2.0 * std::numbers::pi);
  snapshot.width = message.width();
  snapshot.height = message.height();
  snapshot.jpeg = std::move(message.data());
  snapshot.visible = ToVisible(checks, message.view(), snapshot.grid);
  snapshot.goals_left = checks.CellsAt("goals_left", message.goals_left(), snapshot.grid);
  return checks.OrFailure(std::move(snapshot));
}

conav_msgs::msg::Snapshot ToMessage(const Snapshot& snapshot) {
  conav_msgs::msg::Snapshot message;
  WriteAddress(snapshot, message);
  message.sequence_number(snapshot.sequence_number);
  message.streamed(snapshot.streamed);
  message.pose(convert::ToPoseMessage(snapshot.position, snapshot.heading_rad));
  message.horizontal_field_of_view(snapshot.horizontal_fov_rad);
  message.width(snapshot.width);
  message.height(snapshot.height);
  message.format(snapshot.jpeg.empty() ? "none" : "jpeg");
  message.data(snapshot.jpeg);
  message.map_info(convert::ToMapInfo(snapshot.stamp, snapshot.grid));
  message.view(ToView(snapshot.stamp, snapshot.visible, snapshot.grid));
  message.path(ToPoints(snapshot.path, snapshot.grid));
  message.goals_left(ToPoints(snapshot.goals_left, snapshot.grid));
  return message;
}

}  // namespace conav
