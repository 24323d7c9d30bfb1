#include "operator/statistics/descriptives.h"

#include <cmath>
#include <span>

#include "operator/statistics/moments.h"

namespace conav::statistics {
namespace {

/// The values with each subject's mean moved to the mean of all.
ConditionTable WithoutSubjectLevels(const ConditionTable& table) {
  ConditionTable moved = table;
  const double grand_mean = Mean(table.values);
  const std::size_t k = table.condition_count();
  for (std::size_t i = 0; i < table.subject_count(); ++i) {
    const std::span row = std::span(moved.values).subspan(i * k, k);
    const double level = Mean(row);
    for (double& value : row) value += grand_mean - level;
  }
  return moved;
}

}  // namespace

std::vector<Description> Describe(const ConditionTable& table, double alpha) {
  const ConditionTable moved = WithoutSubjectLevels(table);
  const auto n = static_cast<double>(table.subject_count());
  const auto k = static_cast<double>(table.condition_count());
  std::vector<Description> rows;
  for (std::size_t j = 0; j < table.condition_count(); ++j) {
    const std::vector<double> values = ConditionValues(table, j);
    const double mean = Mean(values);
    const double deviation = StandardDeviation(values);
    const double within = StandardDeviation(ConditionValues(moved, j)) * std::sqrt(k / (k - 1.0));
    rows.push_back({.condition = table.conditions[j],
                    .n = table.subject_count(),
                    .mean = mean,
                    .standard_deviation = deviation,
                    .median = Median(values),
                    .mean_interval = StudentInterval(mean, deviation / std::sqrt(n), n - 1, alpha),
                    .within_interval = StudentInterval(mean, within / std::sqrt(n), n - 1, alpha)});
  }
  return rows;
}

}  // namespace conav::statistics
