#pragma once

#include <optional>
#include <vector>

namespace conav::statistics {

/// One p adjusted for the number of tests it is one of; at most 1. Nothing for a test without p.
struct AdjustedP {
  std::optional<double>
      holm;  // Holm, 1979: times m, m - 1, ... from the smallest on, never falling
  std::optional<double> bonferroni;  // m p
  std::optional<double> bh;          // Benjamini and Hochberg, 1995: false discovery rate
};

/// In the order of `p`. Tests without p do not count for m.
std::vector<AdjustedP> AdjustForMany(const std::vector<std::optional<double>>& p);

}  // namespace conav::statistics
