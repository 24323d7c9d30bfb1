#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/runtime/result.h"

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

}  // namespace conav::gaze
