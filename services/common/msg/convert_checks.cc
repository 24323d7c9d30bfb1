#include "common/msg/convert_checks.h"

#include <algorithm>
#include <cmath>

#include "common/msg/convert.h"

namespace conav::convert {
namespace {

constexpr std::size_t kFrameCharactersShown = 40;
constexpr double kMaxCellSize = 1000.0;    // metres
constexpr double kOriginTolerance = 0.01;  // cells
constexpr double kTurnTolerance = 1.0e-3;

/// The middle of the grid by its south-west corner. One that is the frame's origin to a hundredth of
/// a cell is exactly that.
Position MiddleOf(const geometry_msgs::msg::Point& corner, const GridGeometry& centred) {
  const double tolerance = kOriginTolerance * centred.cell_size_m;
  const Position from = centred.origin();
  const Position middle{corner.x() - from.x_m, corner.y() - from.y_m};
  const bool is_centred = std::abs(middle.x_m) <= tolerance && std::abs(middle.y_m) <= tolerance;
  return is_centred ? Position{} : middle;
}

/// All zeros count as not turned.
void CheckNotTurned(Checks& checks, std::string_view prefix,
                    const geometry_msgs::msg::Quaternion& orientation) {
  const auto check = [&](std::string_view axis, double value) {
    const std::string field = fmt::format("{}.origin.orientation.{}", prefix, axis);
    if (std::abs(checks.Finite(field, value)) <= kTurnTolerance) return;
    checks.Refuse(
        fmt::format("{} = {} is not 0: turned maps are refused; turn its picture, or the "
                    "frame map",
                    field, value));
  };
  check("x", orientation.x());
  check("y", orientation.y());
  check("z", orientation.z());
}

void SortUnique(std::vector<Cell>& cells) {
  if (!std::is_sorted(cells.begin(), cells.end())) std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

}  // namespace

SimTime Checks::Time(std::string_view field, const builtin_interfaces::msg::Time& message) {
  const auto time = ToDomain(message);
  if (time) return *time;
  Refuse(fmt::format("{}.{}", field, time.error().text));
  return {};
}

SimTime Checks::Stamp(const std_msgs::msg::Header& header) {
  return Time("header.stamp", header.stamp());
}

void Checks::FrameIsMap(const std_msgs::msg::Header& header) {
  if (header.frame_id() != "map") {
    Refuse(fmt::format("header.frame_id = '{}' is not 'map'",
                       header.frame_id().substr(0, kFrameCharactersShown)));
  }
}

Position Checks::Place(std::string_view field, const geometry_msgs::msg::Point& message) {
  return {Range(fmt::format("{}.x", field), message.x(), -kMaxPosition, kMaxPosition),
          Range(fmt::format("{}.y", field), message.y(), -kMaxPosition, kMaxPosition)};
}

std::vector<Position> Checks::Places(std::string_view field,
                                     const std::vector<geometry_msgs::msg::Pose>& messages) {
  Size(field, messages.size(), kMaxPath);
  std::vector<Position> places;
  for (std::size_t i = 0; i < messages.size() && !failed(); ++i) {
    places.push_back(Place(fmt::format("{}[{}].position", field, i), messages[i].position()));
  }
  return places;
}

std::optional<double> Checks::Yaw(std::string_view field,
                                  const geometry_msgs::msg::Quaternion& message) {
  const double norm =
      std::hypot(std::hypot(message.x(), message.y()), std::hypot(message.z(), message.w()));
  if (norm == 0.0) return std::nullopt;
  if (!(std::abs(norm - 1.0) <= kTurnTolerance) ||
      !(std::hypot(message.x(), message.y()) <= kTurnTolerance)) {
    Refuse(fmt::format("{} = ({}, {}, {}, {}) is not a unit quaternion around z", field,
                       message.x(), message.y(), message.z(), message.w()));
    return std::nullopt;
  }
  return 2.0 * std::atan2(message.z(), message.w());
}

GridGeometry Checks::Geometry(std::string_view prefix, const nav_msgs::msg::MapMetaData& message) {
  const double cell_size_m = Range(fmt::format("{}.resolution", prefix),
                                   static_cast<double>(message.resolution()), 1.0e-3, kMaxCellSize);
  if (!Shape(message.height(), message.width()) || failed()) return {0, 0, 1.0};
  GridGeometry geometry{static_cast<int>(message.height()), static_cast<int>(message.width()),
                        cell_size_m};
  Place(fmt::format("{}.origin.position", prefix), message.origin().position());
  CheckNotTurned(*this, prefix, message.origin().orientation());
  if (failed()) return {0, 0, 1.0};
  geometry.middle = MiddleOf(message.origin().position(), geometry);
  return geometry;
}

std::vector<Cell> Checks::CellsAt(std::string_view field,
                                  const std::vector<geometry_msgs::msg::Point>& messages,
                                  const GridGeometry& geometry) {
  Size(field, messages.size(), kMaxPath);
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < messages.size() && !failed(); ++i) {
    const std::string name = fmt::format("{}[{}]", field, i);
    const Cell cell = geometry.PositionToCell(Place(name, messages[i]));
    Inside(name, cell, static_cast<std::uint32_t>(geometry.rows),
           static_cast<std::uint32_t>(geometry.columns));
    cells.push_back(cell);
  }
  return cells;
}

geometry_msgs::msg::Point ToPoint(Position position) {
  geometry_msgs::msg::Point message;
  message.x(position.x_m);
  message.y(position.y_m);
  return message;
}

geometry_msgs::msg::Pose ToPoseMessage(Position position, std::optional<double> heading_rad) {
  geometry_msgs::msg::Pose message;
  message.position(ToPoint(position));
  if (heading_rad) message.orientation(ToQuaternion(*heading_rad));
  return message;
}

std::vector<geometry_msgs::msg::Point> ToPoints(std::span<const Cell> cells,
                                                const GridGeometry& geometry) {
  std::vector<geometry_msgs::msg::Point> messages;
  messages.reserve(cells.size());
  for (const Cell cell : cells) messages.push_back(ToPoint(geometry.CellToPosition(cell)));
  return messages;
}

std::vector<geometry_msgs::msg::Pose> ToPoses(std::span<const Position> positions) {
  std::vector<geometry_msgs::msg::Pose> messages;
  messages.reserve(positions.size());
  for (const Position position : positions) messages.push_back(ToPoseMessage(position, {}));
  return messages;
}

nav_msgs::msg::MapMetaData ToMapInfo(SimTime stamp, const GridGeometry& geometry) {
  nav_msgs::msg::MapMetaData message;
  message.map_load_time(ToMessage(stamp));
  message.resolution(static_cast<float>(geometry.cell_size_m));
  message.width(static_cast<std::uint32_t>(geometry.columns));
  message.height(static_cast<std::uint32_t>(geometry.rows));
  message.origin(ToPoseMessage(geometry.origin(), 0.0));
  return message;
}

Cell Checks::ToCell(std::string_view field, const conav_msgs::msg::Cell& message,
                    std::uint32_t rows, std::uint32_t columns) {
  const Cell cell{message.row(), message.column()};
  Inside(field, cell, rows, columns);
  return cell;
}

std::vector<Cell> Checks::Cells(std::string_view field,
                                const std::vector<conav_msgs::msg::Cell>& message,
                                std::size_t limit, std::uint32_t rows, std::uint32_t columns) {
  Size(field, message.size(), limit);
  std::vector<Cell> cells;
  if (failed()) return cells;
  cells.reserve(message.size());
  for (const auto& cell : message) cells.push_back({cell.row(), cell.column()});
  Inside(field, cells, rows, columns);
  return cells;
}

VisibleCells Checks::Visible(const std::string& prefix,
                             const std::vector<conav_msgs::msg::Cell>& free_cells,
                             const std::vector<conav_msgs::msg::Cell>& wall_cells,
                             std::uint32_t rows, std::uint32_t columns) {
  VisibleCells visible{Cells(prefix + "free_cells", free_cells, kMaxVisible, rows, columns),
                       Cells(prefix + "wall_cells", wall_cells, kMaxVisible, rows, columns)};
  SortUnique(visible.free);
  SortUnique(visible.walls);
  std::vector<Cell> both;
  std::set_intersection(visible.free.begin(), visible.free.end(), visible.walls.begin(),
                        visible.walls.end(), std::back_inserter(both));
  if (!both.empty()) {
    Refuse(fmt::format("{0}free_cells holds {1}, which {0}wall_cells holds too", prefix,
                       both.front()));
  }
  return visible;
}

conav_msgs::msg::Cell ToCellMessage(Cell cell) {
  conav_msgs::msg::Cell message;
  message.row(cell.row);
  message.column(cell.column);
  return message;
}

std::vector<conav_msgs::msg::Cell> ToCellMessages(std::span<const Cell> cells) {
  std::vector<conav_msgs::msg::Cell> messages;
  messages.reserve(cells.size());
  for (const Cell cell : cells) messages.push_back(ToCellMessage(cell));
  return messages;
}

std::vector<float> ToFloats(const Grid<float>& grid) {
  return {grid.values().begin(), grid.values().end()};
}

}  // namespace conav::convert
