#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "study/gaze/eye_measures.h"

namespace conav::gaze {

/// One row of a CSV file with a header.
class CsvRow {
 public:
  using Columns = std::map<std::string, std::size_t>;

  CsvRow(const Columns& columns, const std::vector<std::string>& fields)
      : columns_(columns), fields_(fields) {}

  const Columns& columns() const { return columns_; }
  /// Whether there is such a column, and the row has something in it.
  bool Has(const std::string& column) const;
  /// Empty if there is none.
  std::string Text(const std::string& column) const;
  bool IsTrue(const std::string& column) const;
  /// Refuses the row if it is not a number.
  double Number(const std::string& column);
  /// The reason to refuse the row; empty = none.
  const std::string& refused() const { return refused_; }

 private:
  const Columns& columns_;
  const std::vector<std::string>& fields_;
  std::string refused_;
};

/// Calls `take` with each row in turn; the file may be larger than the memory. Errors: kNotFound, kIo;
/// kMalformed with file and line.
[[nodiscard]] Result<void> ReadCsvRows(const std::filesystem::path& file,
                                       const std::function<void(CsvRow&)>& take);

/// Reads marks or areas of a whole study: CSV with the columns `utc_s` (s since 1970) and `label`, or
/// `utc_s`, `area`, `x`, `y`, `width`, `height` (rows with the same time are one layout). Other columns
/// of marks are keys. Errors: kMalformed with file, line and column.
[[nodiscard]] Result<std::vector<Mark>> ReadMarks(const std::filesystem::path& file);
[[nodiscard]] Result<std::vector<AreaLayout>> ReadAreas(const std::filesystem::path& file);

}  // namespace conav::gaze
