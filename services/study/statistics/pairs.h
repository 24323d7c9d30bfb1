#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/statistics/moments.h"
#include "study/statistics/table_reader.h"

namespace conav::statistics {

inline constexpr std::size_t kMostShapiroValues = 5000;  // the limit of the algorithm's fit

/// Tests for a normal distribution; W is near 1 for one.
struct ShapiroWilk {
  double w = 0.0;
  double p = 0.0;
};

/// Royston, "Remark AS R94: a remark on algorithm AS 181", Applied Statistics 44, 1995: the weights
/// of the ordered values and the normalising transformation of 1 - W are polynomials in the sample
/// size. Empty for fewer than 3 values, for more than kMostShapiroValues, and for equal ones.
/// `error` bounds the rounding error of a value.
std::optional<ShapiroWilk> TestNormality(std::span<const double> values, double error);

/// Student's t test of two conditions of the same subjects, on the differences first - second. If
/// all differences are equal and not 0, t, d_z and g_z are infinite, p is 0 and the interval is a
/// point; if all are 0, these four are empty.
struct PairedT {
  double mean_difference = 0.0;
  Interval interval;  // of the mean difference
  double df = 0.0;    // n - 1
  std::optional<double> t;
  std::optional<double> p;  // two-sided
  /// Mean over standard deviation of the differences: t = d_z sqrt(n). Cohen, 1988.
  std::optional<double> d_z;
  /// Mean difference over sqrt((s1^2 + s2^2) / 2): in units of the spread between subjects.
  /// Infinite or empty if neither condition varies.
  std::optional<double> d_av;
  /// d_z times Hedges' correction for few subjects, 1 - 3 / (4 df - 1); empty for two subjects.
  std::optional<double> g_z;
};

/// Two values per subject, at least two subjects, in the same order.
PairedT TestPair(std::span<const double> first, std::span<const double> second, double alpha);

/// Wilcoxon's signed rank test, 1945, of first - second. Differences of 0 are left out; V is the
/// sum of the ranks of |difference| over the positive ones. p is two-sided: exact without ties,
/// without zeros and for fewer than 50 differences, else from the normal distribution with the
/// variance corrected for ties and V moved by 1/2 towards its mean. Empty if all differences are 0.
/// Differences that only rounding makes unequal (1.3 - 1.1 and 0.4 - 0.2) are ties.
struct Wilcoxon {
  std::size_t used = 0;  // differences other than 0
  bool exact = false;
  std::optional<double> v;
  std::optional<double> p;
};

/// Two values per subject in the same order.
Wilcoxon TestSignedRanks(std::span<const double> first, std::span<const double> second);

/// A p adjusted for the number of tests; at most 1. Empty for a test without p.
struct AdjustedP {
  std::optional<double>
      holm;  // Holm, 1979: times m, m - 1, ... from the smallest on, never falling
  std::optional<double> bonferroni;  // m p
  std::optional<double> bh;          // Benjamini and Hochberg, 1995: false discovery rate
};

/// In the order of `p`. m excludes tests without p.
std::vector<AdjustedP> AdjustForMany(const std::vector<std::optional<double>>& p);

/// All results for two conditions, from their differences first - second. Each test's p is adjusted
/// for the number of pairs.
struct Pair {
  std::string first;
  std::string second;
  PairedT t;
  AdjustedP t_adjusted;
  Wilcoxon wilcoxon;
  AdjustedP wilcoxon_adjusted;
  // of the differences, which the t test assumes to be normal
  std::optional<ShapiroWilk> normality;
};

/// Every condition with every later one, in the table's order.
std::vector<Pair> ComparePairs(const ConditionTable& table, double alpha);

}  // namespace conav::statistics
