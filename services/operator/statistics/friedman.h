#pragma once

#include <optional>
#include <vector>

#include "operator/statistics/condition_table.h"

namespace conav::statistics {

/// Friedman, 1937: do the conditions differ, going by each subject's ranking of them only. With the
/// rank sums R_j, n subjects, k conditions, and groups of t equal values within a subject:
///   chi^2 = 12 sum_j (R_j - n (k + 1) / 2)^2 / [n k (k + 1) - sum (t^3 - t) / (k - 1)],
/// compared with chi squared of k - 1 degrees of freedom. Where every subject has equal values
/// throughout, chi^2, p and W are nothing.
struct Friedman {
  std::vector<double> mean_ranks;  // per condition
  double df = 0.0;
  std::optional<double> chi_squared;
  std::optional<double> p;
  std::optional<double> kendall_w;  // chi^2 / [n (k - 1)]: 1 where all rank alike
};

Friedman TestRanks(const ConditionTable& table);

}  // namespace conav::statistics
