#include "study/gaze/csv_rows.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include "study/statistics/table_reader.h"

namespace conav::gaze {

bool CsvRow::Has(const std::string& column) const {
  const auto at = columns_.find(column);
  return at != columns_.end() && !fields_[at->second].empty();
}

std::string CsvRow::Text(const std::string& column) const {
  return Has(column) ? fields_[columns_.at(column)] : std::string();
}

bool CsvRow::IsTrue(const std::string& column) const {
  const std::string text = Text(column);
  return text == "True" || text == "true" || text == "1";
}

double CsvRow::Number(const std::string& column) {
  const std::string text = Text(column);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number =
      error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
  if (!is_number && refused_.empty()) {
    refused_ = columns_.contains(column)
                   ? fmt::format("column {}: '{}' is not a number", column, text)
                   : fmt::format("there is no column {}", column);
  }
  return value;
}

Result<void> ReadCsvRows(const std::filesystem::path& path,
                         const std::function<void(CsvRow&)>& take) {
  std::ifstream file(path);
  if (!file.is_open()) {
    if (!std::filesystem::exists(path)) {
      return Fail(ErrorCode::kNotFound, path.string() + ": no such file");
    }
    return Fail(ErrorCode::kIo, path.string() + ": cannot be read");
  }
  CsvRow::Columns columns;
  std::string line;
  for (std::size_t number = 1; std::getline(file, line); ++number) {
    const auto refuse = [&](const std::string& reason) {
      return Fail(ErrorCode::kMalformed, fmt::format("{}:{}: {}", path.string(), number, reason));
    };
    if (line.ends_with('\r')) line.pop_back();
    if (line.empty()) continue;
    const auto fields = statistics::SplitCsvRow(line);
    if (!fields) return refuse(fields.error().text);
    if (columns.empty()) {
      for (std::size_t i = 0; i < fields->size(); ++i) columns.emplace((*fields)[i], i);
      if (columns.size() != fields->size()) return refuse("names a column twice");
      continue;
    }
    if (fields->size() != columns.size()) {
      return refuse(fmt::format("has {} columns, its header {}", fields->size(), columns.size()));
    }
    CsvRow row(columns, *fields);
    take(row);
    if (!row.refused().empty()) return refuse(row.refused());
  }
  if (file.bad()) return Fail(ErrorCode::kIo, path.string() + ": cannot be read to its end");
  return {};
}

Result<std::vector<Mark>> ReadMarks(const std::filesystem::path& file) {
  std::vector<Mark> marks;
  const auto read = ReadCsvRows(file, [&](CsvRow& row) {
    Mark mark{row.Number("utc_s"), row.Text("label"), {}};
    for (const auto& [column, index] : row.columns()) {
      const bool is_key = column != "utc_s" && column != "label";
      if (is_key && row.Has(column)) mark.keys[column] = row.Text(column);
    }
    marks.push_back(std::move(mark));
  });
  if (!read) return tl::unexpected(read.error());
  std::ranges::stable_sort(marks, {}, &Mark::time_s);
  return marks;
}

Result<std::vector<AreaLayout>> ReadAreas(const std::filesystem::path& file) {
  std::map<double, AreaLayout> layouts;
  const auto read = ReadCsvRows(file, [&](CsvRow& row) {
    const double time = row.Number("utc_s");
    AreaLayout& layout = layouts[time];
    layout.time_s = time;
    layout.areas.push_back({row.Text("area"), row.Number("x"), row.Number("y"), row.Number("width"),
                            row.Number("height")});
  });
  if (!read) return tl::unexpected(read.error());
  std::vector<AreaLayout> ordered;
  for (auto& [time, layout] : layouts) ordered.push_back(std::move(layout));
  return ordered;
}

}  // namespace conav::gaze
