#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/msg/convert.h"
#include "common/msg/convert_checks.h"

// Standard ROS messages: time, maps, poses, camera.
namespace conav {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr std::int64_t kMaxSeconds = std::numeric_limits<std::int32_t>::max();
constexpr double kMaxFovRad = 2.6;  // 149 degrees: a planar image cannot usefully show more
constexpr int kFreeUpTo = 25;
constexpr int kOccupiedFrom = 65;

Occupancy ToOccupancy(std::int8_t value) {
  if (value >= 0 && value <= kFreeUpTo) return Occupancy::kFree;
  return value >= kOccupiedFrom ? Occupancy::kOccupied : Occupancy::kUnknown;
}

std::int8_t ToByte(Occupancy occupancy) {
  switch (occupancy) {
    case Occupancy::kFree:
      return 0;
    case Occupancy::kOccupied:
      return 100;
    case Occupancy::kUnknown:
      break;
  }
  return -1;
}

/// Index into a message's `data`, which starts at the southern row.
std::size_t SouthernIndex(Cell cell, int rows, int columns) {
  return static_cast<std::size_t>(rows - 1 - cell.row) * static_cast<std::size_t>(columns) +
         static_cast<std::size_t>(cell.column);
}

nav_msgs::msg::OccupancyGrid EmptyMap(SimTime stamp, const GridGeometry& geometry) {
  nav_msgs::msg::OccupancyGrid message;
  message.header(ToHeader(stamp));
  message.info(convert::ToMapInfo(stamp, geometry));
  message.data().resize(
      static_cast<std::size_t>(geometry.rows) * static_cast<std::size_t>(geometry.columns), -1);
  return message;
}

void FillCells(convert::Checks& checks, const std::vector<std::int8_t>& data, MapUpdate& map) {
  for (std::size_t i = 0; i < data.size(); ++i) {
    if (data[i] < -1 || data[i] > 100) {
      return checks.Refuse(
          fmt::format("data[{}] = {} is not in [-1, 100]", i, static_cast<int>(data[i])));
    }
    const Cell from_south = map.cells.CellAt(i);
    map.cells[{map.cells.rows() - 1 - from_south.row, from_south.column}] = ToOccupancy(data[i]);
  }
}

geometry_msgs::msg::PoseStamped ToPose(SimTime stamp, Position position, double heading_rad) {
  geometry_msgs::msg::PoseStamped message;
  message.header(ToHeader(stamp));
  message.pose().position().x(position.x_m);
  message.pose().position().y(position.y_m);
  message.pose().orientation(ToQuaternion(heading_rad));
  return message;
}

}  // namespace

Result<SimTime> ToDomain(const builtin_interfaces::msg::Time& message) {
  convert::Checks checks;
  if (message.sec() < 0) checks.Refuse(fmt::format("sec = {} is below 0", message.sec()));
  if (message.nanosec() >= kNanosecondsPerSecond) {
    checks.Refuse(
        fmt::format("nanosec = {} is not below {}", message.nanosec(), kNanosecondsPerSecond));
  }
  if (checks.failed()) return checks.failure();
  return SimTime{message.sec() * kNanosecondsPerSecond + message.nanosec()};
}

builtin_interfaces::msg::Time ToMessage(SimTime time) {
  const std::int64_t highest = kMaxSeconds * kNanosecondsPerSecond + kNanosecondsPerSecond - 1;
  const std::int64_t nanoseconds = std::clamp<std::int64_t>(time.nanoseconds, 0, highest);
  builtin_interfaces::msg::Time message;
  message.sec(static_cast<std::int32_t>(nanoseconds / kNanosecondsPerSecond));
  message.nanosec(static_cast<std::uint32_t>(nanoseconds % kNanosecondsPerSecond));
  return message;
}

std_msgs::msg::Header ToHeader(SimTime stamp) {
  std_msgs::msg::Header header;
  header.stamp(ToMessage(stamp));
  header.frame_id(std::string(kMapFrame));
  return header;
}

Result<MapUpdate> ToDomain(const nav_msgs::msg::OccupancyGrid& message) {
  convert::Checks checks;
  const auto& info = message.info();
  MapUpdate map;
  map.stamp = checks.Stamp(message.header());
  checks.FrameIsMap(message.header());
  const GridGeometry geometry = checks.Geometry("info", info);
  if (geometry.rows == 0) return checks.failure();
  map.cell_size_m = geometry.cell_size_m;
  map.middle = geometry.middle;
  map.cells = OccupancyGrid(geometry.rows, geometry.columns);
  if (message.data().size() != map.cells.size()) {
    checks.Refuse(fmt::format("data has size {}, not {} x {}", message.data().size(), info.height(),
                              info.width()));
  }
  if (!checks.failed()) FillCells(checks, message.data(), map);
  return checks.OrFailure(std::move(map));
}

nav_msgs::msg::OccupancyGrid ToMessage(const MapUpdate& map) {
  const int rows = map.cells.rows();
  const int columns = map.cells.columns();
  auto message = EmptyMap(map.stamp, map.geometry());
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    const Cell cell = map.cells.CellAt(i);
    message.data()[SouthernIndex(cell, rows, columns)] = ToByte(map.cells[cell]);
  }
  return message;
}

nav_msgs::msg::OccupancyGrid ToOccupancyMessage(const Belief& belief) {
  const BeliefGrid& grid = belief.wall_probability;
  auto message = EmptyMap(belief.stamp, belief.geometry());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Cell cell = grid.CellAt(i);
    message.data()[SouthernIndex(cell, grid.rows(), grid.columns())] =
        static_cast<std::int8_t>(std::lround(static_cast<double>(grid[cell]) * 100.0));
  }
  return message;
}

Result<CameraLens> ToDomain(const sensor_msgs::msg::CameraInfo& message) {
  convert::Checks checks;
  const double width = checks.Range("width", message.width(), 1.0, convert::kMaxImageSide);
  const double height = checks.Range("height", message.height(), 1.0, convert::kMaxImageSide);
  const auto focal = [&checks](std::string_view field, double value) {
    if (!(value > 0.0) || !std::isfinite(value)) {
      checks.Refuse(fmt::format("{} = {} is not a focal length in pixels", field, value));
    }
    return value;
  };
  const double focal_x = focal("k[0]", message.k()[0]);
  const double focal_y = focal("k[4]", message.k()[4]);
  if (checks.failed()) return checks.failure();
  CameraLens lens{static_cast<int>(width), static_cast<int>(height)};
  lens.horizontal_fov_rad = checks.Range("horizontal field of view (from width and k[0])",
                                         2.0 * std::atan(width / 2.0 / focal_x), 0.0, kMaxFovRad);
  lens.vertical_fov_rad = checks.Range("vertical field of view (from height and k[4])",
                                       2.0 * std::atan(height / 2.0 / focal_y), 0.0, kMaxFovRad);
  return checks.OrFailure(std::move(lens));
}

Result<Position> ToDomain(const geometry_msgs::msg::PoseStamped& message) {
  convert::Checks checks;
  checks.FrameIsMap(message.header());
  const Position goal = checks.Place("pose.position", message.pose().position());
  return checks.OrFailure(std::move(goal));
}

nav_msgs::msg::Path ToPathMessage(SimTime stamp, std::span<const Cell> path,
                                  const GridGeometry& geometry) {
  nav_msgs::msg::Path message;
  message.header(ToHeader(stamp));
  double heading_rad = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i + 1 < path.size()) heading_rad = HeadingTowards(path[i], path[i + 1]);
    message.poses().push_back(ToPose(stamp, geometry.CellToPosition(path[i]), heading_rad));
  }
  return message;
}

std::vector<Position> ToPositions(const nav_msgs::msg::Path& message) {
  std::vector<Position> positions;
  for (const auto& pose : message.poses()) {
    const auto& position = pose.pose().position();
    positions.push_back({position.x(), position.y()});
  }
  return positions;
}

geometry_msgs::msg::Quaternion ToQuaternion(double yaw_rad) {
  geometry_msgs::msg::Quaternion message;
  message.z(std::sin(yaw_rad / 2.0));
  message.w(std::cos(yaw_rad / 2.0));
  return message;
}

geometry_msgs::msg::Quaternion ToQuaternion(const FramePose& pose) {
  const double sin_roll = std::sin(pose.roll_rad / 2.0), cos_roll = std::cos(pose.roll_rad / 2.0);
  const double sin_pitch = std::sin(pose.pitch_rad / 2.0);
  const double cos_pitch = std::cos(pose.pitch_rad / 2.0);
  const double sin_yaw = std::sin(pose.yaw_rad / 2.0), cos_yaw = std::cos(pose.yaw_rad / 2.0);
  geometry_msgs::msg::Quaternion message;
  message.x(sin_roll * cos_pitch * cos_yaw - cos_roll * sin_pitch * sin_yaw);
  message.y(cos_roll * sin_pitch * cos_yaw + sin_roll * cos_pitch * sin_yaw);
  message.z(cos_roll * cos_pitch * sin_yaw - sin_roll * sin_pitch * cos_yaw);
  message.w(cos_roll * cos_pitch * cos_yaw + sin_roll * sin_pitch * sin_yaw);
  return message;
}

nav_msgs::msg::Odometry ToOdometry(SimTime stamp, const RobotMotion& motion) {
  nav_msgs::msg::Odometry message;
  message.header().stamp(ToMessage(stamp));
  message.header().frame_id(std::string(kOdometryFrame));
  message.child_frame_id(std::string(kBaseFrame));
  message.pose().pose(ToPose(stamp, motion.position, motion.heading_rad).pose());
  message.twist().twist().linear().x(motion.forward_m_per_s);
  message.twist().twist().angular().z(motion.turn_rad_per_s);
  return message;
}

geometry_msgs::msg::TransformStamped ToTransform(SimTime stamp, std::string_view robot,
                                                 std::string_view parent, std::string_view child,
                                                 const FramePose& pose) {
  geometry_msgs::msg::TransformStamped message;
  message.header().stamp(ToMessage(stamp));
  message.header().frame_id(FrameId(robot, parent));
  message.child_frame_id(FrameId(robot, child));
  message.transform().translation().x(pose.x_m);
  message.transform().translation().y(pose.y_m);
  message.transform().translation().z(pose.z_m);
  message.transform().rotation(ToQuaternion(pose));
  return message;
}

}  // namespace conav
