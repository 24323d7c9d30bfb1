#pragma once

#include <optional>
#include <string>
#include <vector>

#include "operator/statistics/condition_table.h"
#include "operator/statistics/p_adjustment.h"
#include "operator/statistics/paired_t.h"
#include "operator/statistics/shapiro_wilk.h"
#include "operator/statistics/wilcoxon.h"

namespace conav::statistics {

/// All that is computed of two conditions, from their differences first - second. Each test's p is
/// adjusted for the number of pairs.
struct Pair {
  std::string first;
  std::string second;
  PairedT t;
  AdjustedP t_adjusted;
  Wilcoxon wilcoxon;
  AdjustedP wilcoxon_adjusted;
  std::optional<ShapiroWilk> normality;  // of the differences, which the t test takes for normal
};

/// Every condition with every later one, in the table's order.
std::vector<Pair> ComparePairs(const ConditionTable& table, double alpha);

}  // namespace conav::statistics
