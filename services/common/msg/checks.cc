#include "common/msg/checks.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "common/msg/robot.h"
#include "common/runtime/text.h"

namespace conav::convert {
namespace {

constexpr std::size_t kShownCharacters = 40;
constexpr std::size_t kChecksumDigits = 64;  // SHA-256

bool IsInside(Cell cell, std::uint32_t rows, std::uint32_t columns) {
  const auto inside = [](int value, std::uint32_t limit) {
    return value >= 0 && static_cast<std::uint32_t>(value) < limit;
  };
  return inside(cell.row, rows) && inside(cell.column, columns);
}

}  // namespace

void ValueChecks::Refuse(std::string text) {
  if (!error_) error_ = Error{ErrorCode::kMalformed, std::move(text)};
}

std::string ValueChecks::Characters(std::string_view field, const std::string& value,
                                    std::size_t limit, std::string_view extra) {
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

std::string ValueChecks::Name(std::string_view field, const std::string& value) {
  return Characters(field, value, kMaxName, "");
}

std::string ValueChecks::Client(std::string_view field, const std::string& value) {
  return Characters(field, value, kMaxClient, ".:@/-");
}

std::string ValueChecks::OptionalName(std::string_view field, const std::string& value) {
  return value.empty() ? value : Name(field, value);
}

std::string ValueChecks::OptionalClient(std::string_view field, const std::string& value) {
  return value.empty() ? value : Client(field, value);
}

std::string ValueChecks::Checksum(std::string_view field, const std::string& value) {
  const bool digits = value.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (!value.empty() && (!digits || value.size() != kChecksumDigits)) {
    Refuse(fmt::format("{} = '{}' is not {} hexadecimal digits", field,
                       value.substr(0, kShownCharacters), kChecksumDigits));
  }
  return value;
}

std::string ValueChecks::Text(std::string_view field, const std::string& value) {
  Size(field, value.size(), kMaxText);
  return failed() ? std::string() : Readable(value);
}

double ValueChecks::Finite(std::string_view field, double value) {
  if (!std::isfinite(value)) Refuse(fmt::format("{} = {} is not finite", field, value));
  return value;
}

double ValueChecks::Range(std::string_view field, double value, double low, double high) {
  Finite(field, value);
  if (value < low || value > high) {
    Refuse(fmt::format("{} = {} is not in [{}, {}]", field, value, low, high));
  }
  return value;
}

double ValueChecks::Heading(std::string_view field, double value) {
  return Range(field, value, -2.0 * std::numbers::pi, 2.0 * std::numbers::pi);
}

void ValueChecks::Size(std::string_view field, std::size_t size, std::size_t limit) {
  if (size > limit) Refuse(fmt::format("{} has size {}, more than {}", field, size, limit));
}

void ValueChecks::InFrame(std::string_view field, const std::vector<Position>& places) {
  Size(field, places.size(), kMaxPath);
  for (std::size_t i = 0; i < places.size() && !failed(); ++i) {
    Range(fmt::format("{}[{}].x", field, i), places[i].x_m, -kMaxPosition, kMaxPosition);
    Range(fmt::format("{}[{}].y", field, i), places[i].y_m, -kMaxPosition, kMaxPosition);
  }
}

bool ValueChecks::Shape(std::uint32_t rows, std::uint32_t columns) {
  const auto check = [this](std::string_view field, std::uint32_t value) {
    const bool good = value >= 1 && value <= kMaxSide;
    if (!good) Refuse(fmt::format("{} = {} is not in [1, {}]", field, value, kMaxSide));
    return good;
  };
  return check("rows", rows) && check("columns", columns);
}

Grid<float> ValueChecks::Probabilities(std::string_view field, const std::vector<float>& values,
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

void ValueChecks::Positive(std::string_view field, double value, double high) {
  Range(field, value, 0.0, high);
  if (value <= 0.0) Refuse(fmt::format("{} = 0 is not above 0", field));
}

void ValueChecks::AtLeastOne(std::string_view field, std::uint64_t value) {
  if (value == 0) Refuse(fmt::format("{} = 0 is below 1", field));
}

void ValueChecks::Inside(std::string_view field, Cell cell, std::uint32_t rows,
                         std::uint32_t columns) {
  if (IsInside(cell, rows, columns)) return;
  Refuse(fmt::format("{} = ({},{}) is outside of {} x {} cells", field, cell.row, cell.column, rows,
                     columns));
}

void ValueChecks::Inside(std::string_view field, std::span<const Cell> cells, std::uint32_t rows,
                         std::uint32_t columns) {
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (IsInside(cells[i], rows, columns)) continue;
    return Inside(fmt::format("{}[{}]", field, i), cells[i], rows, columns);
  }
}

}  // namespace conav::convert
