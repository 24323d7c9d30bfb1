#pragma once

#include <string>
#include <vector>

#include "study/statistics/anova.h"
#include "study/statistics/moments.h"
#include "study/statistics/pairs.h"
#include "study/statistics/table_reader.h"

namespace conav::statistics {

/// One condition by itself.
struct Description {
  std::string condition;
  std::size_t n = 0;
  double mean = 0.0;
  double standard_deviation = 0.0;
  double median = 0.0;
  /// Confidence interval of the mean over such people: Student's t, n - 1 degrees of freedom.
  Interval mean_interval;
  /// For comparing conditions: the same after removing each subject's own level (Cousineau,
  /// "Confidence intervals in within-subject designs", 2005), with the standard error times sqrt(k
  /// / (k - 1)) for k conditions (Morey, 2008).
  Interval within_interval;
};

/// A row per condition; intervals hold with probability 1 - alpha.
std::vector<Description> Describe(const ConditionTable& table, double alpha);

/// All results for one table.
struct Analysis {
  std::string file;    // its name, without folder
  std::string sha256;  // of its bytes
  double alpha = 0.05;
  ConditionTable table;
  std::vector<LeftOut> left_out;
  std::vector<Description> conditions;
  Anova anova;
  std::vector<Pair> pairs;
  Friedman friedman;
  /// Remarks for the reader: which subjects were left out, which figures are missing and why. One
  /// sentence each.
  std::vector<std::string> notes;
};

/// Confidence intervals hold with probability 1 - alpha; alpha in (0, 1).
Analysis Analyse(TableFile file, double alpha);

}  // namespace conav::statistics
