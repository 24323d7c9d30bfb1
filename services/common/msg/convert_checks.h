#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/msg/checks.h"
#include "common/msg/convert.h"
#include "common/msg/planning.h"
#include "common/msg/robot.h"
#include "conav_msgs.h"
#include "ros2_interfaces.h"

/// Checks that the convert_*.cc files share; for them only.
namespace conav::convert {

/// The checks of what generated IDL types carry.
class Checks : public ValueChecks {
 public:
  SimTime Time(std::string_view field, const builtin_interfaces::msg::Time& message);
  SimTime Stamp(const std_msgs::msg::Header& header);
  /// Stamp, world and robot of `message`, as most have them.
  template <class Message, class Value>
  void Address(const Message& message, Value& value) {
    value.stamp = Stamp(message.header());
    value.world = Name("world", message.world());
    value.robot = Name("robot", message.robot());
  }
  void FrameIsMap(const std_msgs::msg::Header& header);
  /// Within 1000 km of the origin.
  Position Place(std::string_view field, const geometry_msgs::msg::Point& message);
  std::vector<Position> Places(std::string_view field,
                               const std::vector<geometry_msgs::msg::Pose>& messages);
  /// Yaw of a unit quaternion that turns around z; nothing where all are zeros.
  std::optional<double> Yaw(std::string_view field, const geometry_msgs::msg::Quaternion& message);
  /// `prefix` is "map_info" or "info". Of any origin, but not turned; without rows on failure.
  GridGeometry Geometry(std::string_view prefix, const nav_msgs::msg::MapMetaData& message);
  /// The cells that hold the places.
  std::vector<Cell> CellsAt(std::string_view field,
                            const std::vector<geometry_msgs::msg::Point>& messages,
                            const GridGeometry& geometry);
  Cell ToCell(std::string_view field, const conav_msgs::msg::Cell& message,
              std::uint32_t rows = kMaxSide, std::uint32_t columns = kMaxSide);
  std::vector<Cell> Cells(std::string_view field, const std::vector<conav_msgs::msg::Cell>& message,
                          std::size_t limit = kMaxPath, std::uint32_t rows = kMaxSide,
                          std::uint32_t columns = kMaxSide);
  /// Sorts the cells of a foreign sender; rejects a cell that is in both lists.
  VisibleCells Visible(const std::string& prefix,
                       const std::vector<conav_msgs::msg::Cell>& free_cells,
                       const std::vector<conav_msgs::msg::Cell>& wall_cells,
                       std::uint32_t rows = kMaxSide, std::uint32_t columns = kMaxSide);
};

template <class Value, class Message>
void WriteAddress(const Value& value, Message& message) {
  message.header(ToHeader(value.stamp));
  message.world(value.world);
  message.robot(value.robot);
}
geometry_msgs::msg::Point ToPoint(Position position);
/// Any heading where it is absent.
geometry_msgs::msg::Pose ToPoseMessage(Position position, std::optional<double> heading_rad);
std::vector<geometry_msgs::msg::Point> ToPoints(std::span<const Cell> cells,
                                                const GridGeometry& geometry);
std::vector<geometry_msgs::msg::Pose> ToPoses(std::span<const Position> positions);
nav_msgs::msg::MapMetaData ToMapInfo(SimTime stamp, const GridGeometry& geometry);
conav_msgs::msg::Cell ToCellMessage(Cell cell);
std::vector<conav_msgs::msg::Cell> ToCellMessages(std::span<const Cell> cells);
std::vector<float> ToFloats(const Grid<float>& grid);

}  // namespace conav::convert
