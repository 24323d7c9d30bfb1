#include "common/msg/convert_checks.h"

#include <algorithm>

#include "common/msg/convert.h"

namespace conav::convert {
namespace {

constexpr std::size_t kFrameCharactersShown = 40;

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
