#include "common/msg/convert_checks.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/msg/convert.h"
#include "common/runtime/text.h"

namespace conav::convert {
namespace {

constexpr std::size_t kShownCharacters = 40;
constexpr std::size_t kChecksumDigits = 64;  // SHA-256

void SortUnique(std::vector<Cell>& cells) {
  if (!std::is_sorted(cells.begin(), cells.end())) std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

}  // namespace

void Checks::Refuse(std::string text) {
  if (!error_) error_ = Error{ErrorCode::kMalformed, std::move(text)};
}

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
                       header.frame_id().substr(0, kShownCharacters)));
  }
}

std::string Checks::Characters(std::string_view field, const std::string& value, std::size_t limit,
                               std::string_view extra) {
  if (value.empty()) Refuse(fmt::format("{} is empty", field));
  Size(field, value.size(), limit);
  for (const char c : value) {
    if (IsNameCharacter(c) || extra.find(c) != std::string_view::npos) continue;
    Refuse(fmt::format("{} = '{}' has a character outside of [A-Za-z0-9_{}]", field,
                       value.substr(0, kShownCharacters), extra));
    break;
  }
  return value;
}

std::string Checks::Name(std::string_view field, const std::string& value) {
  return Characters(field, value, kMaxName, "");
}

std::string Checks::Client(std::string_view field, const std::string& value) {
  return Characters(field, value, kMaxClient, ".:@/-");
}

std::string Checks::OptionalName(std::string_view field, const std::string& value) {
  return value.empty() ? value : Name(field, value);
}

std::string Checks::OptionalClient(std::string_view field, const std::string& value) {
  return value.empty() ? value : Client(field, value);
}

std::string Checks::Checksum(std::string_view field, const std::string& value) {
  const bool digits = value.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (!value.empty() && (!digits || value.size() != kChecksumDigits)) {
    Refuse(fmt::format("{} = '{}' is not {} hexadecimal digits", field,
                       value.substr(0, kShownCharacters), kChecksumDigits));
  }
  return value;
}

std::string Checks::Text(std::string_view field, const std::string& value) {
  Size(field, value.size(), kMaxText);
  return failed() ? std::string() : Readable(value);
}

double Checks::Finite(std::string_view field, double value) {
  if (!std::isfinite(value)) Refuse(fmt::format("{} = {} is not finite", field, value));
  return value;
}

double Checks::Range(std::string_view field, double value, double low, double high) {
  Finite(field, value);
  if (value < low || value > high) {
    Refuse(fmt::format("{} = {} is not in [{}, {}]", field, value, low, high));
  }
  return value;
}

double Checks::Heading(std::string_view field, double value) {
  return Range(field, value, -2.0 * std::numbers::pi, 2.0 * std::numbers::pi);
}

void Checks::Size(std::string_view field, std::size_t size, std::size_t limit) {
  if (size > limit) Refuse(fmt::format("{} has size {}, more than {}", field, size, limit));
}

Cell Checks::ToCell(std::string_view field, const conav_msgs::msg::Cell& message,
                    std::uint32_t rows, std::uint32_t columns) {
  const auto inside = [](std::int32_t value, std::uint32_t limit) {
    return value >= 0 && static_cast<std::uint32_t>(value) < limit;
  };
  if (!inside(message.row(), rows) || !inside(message.column(), columns)) {
    Refuse(fmt::format("{} = ({},{}) is outside of {} x {} cells", field, message.row(),
                       message.column(), rows, columns));
  }
  return {message.row(), message.column()};
}

std::vector<Cell> Checks::Cells(std::string_view field,
                                const std::vector<conav_msgs::msg::Cell>& message,
                                std::size_t limit, std::uint32_t rows, std::uint32_t columns) {
  Size(field, message.size(), limit);
  std::vector<Cell> cells;
  if (failed()) return cells;
  cells.reserve(message.size());
  Checks inner;
  for (const auto& cell : message) {
    cells.push_back(inner.ToCell("", cell, rows, columns));
    if (inner.failed()) {
      Refuse(fmt::format("{}[{}]{}", field, cells.size() - 1, inner.error_->text));
      break;
    }
  }
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

bool Checks::Shape(std::uint32_t rows, std::uint32_t columns) {
  const auto check = [this](std::string_view field, std::uint32_t value) {
    const bool good = value >= 1 && value <= kMaxSide;
    if (!good) Refuse(fmt::format("{} = {} is not in [1, {}]", field, value, kMaxSide));
    return good;
  };
  return check("rows", rows) && check("columns", columns);
}

Grid<float> Checks::Probabilities(std::string_view field, const std::vector<float>& values,
                                  int rows, int columns) {
  Grid<float> grid(rows, columns);
  if (values.size() != grid.size()) {
    Refuse(fmt::format("{} has size {}, not {} x {}", field, values.size(), rows, columns));
    return grid;
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const float value = values[i];
    if (!(value >= 0.0F && value <= 1.0F)) {
      Refuse(fmt::format("{}[{}] = {} is not in [0, 1]", field, i, value));
      return grid;
    }
    grid.values()[i] = value;
  }
  return grid;
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
