#pragma once

#include <string>
#include <vector>

#include "operator/statistics/condition_table.h"
#include "operator/statistics/interval.h"

namespace conav::statistics {

/// One condition by itself.
struct Description {
  std::string condition;
  std::size_t n = 0;
  double mean = 0.0;
  double standard_deviation = 0.0;
  double median = 0.0;
  /// Where the mean of people like these lies: Student's t, n - 1 degrees of freedom.
  Interval mean_interval;
  /// For comparing conditions: the same after each subject's own level is taken out (Cousineau,
  /// "Confidence intervals in within-subject designs", 2005), with the standard error times
  /// sqrt(k / (k - 1)) for k conditions (Morey, 2008).
  Interval within_interval;
};

/// A row per condition; intervals hold with probability 1 - alpha.
std::vector<Description> Describe(const ConditionTable& table, double alpha);

}  // namespace conav::statistics
