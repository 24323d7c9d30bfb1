#include "operator/statistics/condition_table.h"

#include "operator/statistics/moments.h"

namespace conav::statistics {

std::vector<double> ConditionValues(const ConditionTable& table, std::size_t condition) {
  std::vector<double> values;
  values.reserve(table.subject_count());
  for (std::size_t i = 0; i < table.subject_count(); ++i) values.push_back(table.At(i, condition));
  return values;
}

double Magnitude(const ConditionTable& table) { return Magnitude(std::span(table.values)); }

}  // namespace conav::statistics
