#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/result.h"

namespace conav::statistics {

/// The fields of one line of comma-separated values (RFC 4180, without line breaks in a field),
/// without spaces around them. Errors: kMalformed for a quote that is not closed, or not followed
/// by a comma.
[[nodiscard]] Result<std::vector<std::string>> SplitCsvRow(std::string_view line);

/// One measured value per subject and condition, none missing. At least two subjects and two
/// conditions; all values are finite.
struct ConditionTable {
  std::vector<std::string> conditions;
  std::vector<std::string> subjects;
  std::vector<double> values;  // [subjects, conditions], the row of a subject together

  std::size_t subject_count() const { return subjects.size(); }
  std::size_t condition_count() const { return conditions.size(); }
  double At(std::size_t subject, std::size_t condition) const {
    return values[subject * conditions.size() + condition];
  }
};

/// The values of all subjects in one condition.
std::vector<double> ConditionValues(const ConditionTable& table, std::size_t condition);

/// The largest absolute value: the scale of rounding errors.
double Magnitude(const ConditionTable& table);

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
inline constexpr double kLargestValue = 1.0e100;  // 1 / this is the smallest value besides 0

/// Reads comma-separated values:
///
///   subject,<condition>,<condition>,...
///   p01,12,15.5,...
///
/// one row per subject, decimal point, quotes as in RFC 4180; skips empty lines. Leaves out a
/// subject with an empty cell (or NA). Errors: kMalformed with `name`, line and column for anything
/// else: another header, a missing or repeated name, a cell too few or too many, a cell that is no
/// number, a value out of range, text that is not UTF-8, fewer than two conditions or complete
/// subjects.
[[nodiscard]] Result<TableFile> ParseTable(std::string_view text, const std::string& name);

}  // namespace conav::statistics
