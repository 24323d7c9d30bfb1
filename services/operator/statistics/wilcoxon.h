#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace conav::statistics {

/// Wilcoxon's signed rank test, 1945, of first - second. Differences of 0 are left out; V is the
/// sum of the ranks of |difference| over the positive ones. p is two-sided: exact where there are
/// no ties, no zeros and fewer than 50 differences, else from the normal distribution with the
/// variance corrected for ties and V moved by 1/2 towards its mean. Nothing where all differences
/// are 0. Differences that only rounding makes unequal (1.3 - 1.1 and 0.4 - 0.2) are ties.
struct Wilcoxon {
  std::size_t used = 0;  // differences other than 0
  bool exact = false;
  std::optional<double> v;
  std::optional<double> p;
};

/// Two values per subject in the same order.
Wilcoxon TestSignedRanks(std::span<const double> first, std::span<const double> second);

}  // namespace conav::statistics
