#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/result.h"
#include "operator/statistics/condition_table.h"

namespace conav::statistics {

/// A subject with an empty cell.
struct LeftOut {
  std::string subject;
  std::size_t line = 0;
  std::vector<std::string> missing;  // the conditions without a value
};

struct TableFile {
  ConditionTable table;
  std::vector<LeftOut> left_out;
};

inline constexpr std::size_t kMostConditions = 64;
inline constexpr double kLargestValue = 1.0e100;  // and 1 / this is the smallest but 0

/// Reads comma-separated values:
///
///   subject,<condition>,<condition>,...
///   p01,12,15.5,...
///
/// one row per subject, decimal point, quotes as in RFC 4180; empty lines are skipped. A subject
/// with an empty cell (or NA) is left out of everything. Errors: kMalformed with `name`, line and
/// column for whatever else is not as it must be: another header, a name missing or twice, a cell
/// too few or too many, what is not a number, a value out of range, text that is not UTF-8, fewer
/// than two conditions or complete subjects.
[[nodiscard]] Result<TableFile> ParseTable(std::string_view text, const std::string& name);

}  // namespace conav::statistics
