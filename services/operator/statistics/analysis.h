#pragma once

#include <string>
#include <vector>

#include "operator/statistics/anova.h"
#include "operator/statistics/descriptives.h"
#include "operator/statistics/friedman.h"
#include "operator/statistics/pairs.h"
#include "operator/statistics/table_reader.h"

namespace conav::statistics {

/// All that is computed of one table.
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
  /// What a reader of the figures must know: who was left out, which figures there cannot be and
  /// why. One sentence each.
  std::vector<std::string> notes;
};

/// Confidence intervals hold with probability 1 - alpha; alpha in (0, 1).
Analysis Analyse(TableFile file, double alpha);

}  // namespace conav::statistics
