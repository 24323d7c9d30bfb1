#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/result.h"

namespace conav::statistics {

/// The fields of one line of comma-separated values (RFC 4180, without line breaks in a field),
/// without spaces around them. Errors: kMalformed for a quote that does not end, or not at a comma.
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

/// The largest absolute value: what rounding errors are measured by.
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
