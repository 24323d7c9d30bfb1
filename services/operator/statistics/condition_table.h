#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace conav::statistics {

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

}  // namespace conav::statistics
