#pragma once

#include <optional>
#include <span>

#include "operator/statistics/interval.h"

namespace conav::statistics {

/// Student's t test of two conditions of the same subjects, on the differences first - second.
/// Where all differences are equal and not 0, t, d_z and g_z are infinite, p is 0 and the interval
/// is a point; where all are 0, these four are nothing.
struct PairedT {
  double mean_difference = 0.0;
  Interval interval;  // of the mean difference
  double df = 0.0;    // n - 1
  std::optional<double> t;
  std::optional<double> p;  // two-sided
  /// Mean over standard deviation of the differences: t = d_z sqrt(n). Cohen, 1988.
  std::optional<double> d_z;
  /// Mean difference over sqrt((s1^2 + s2^2) / 2): in units of the spread between subjects.
  /// Infinite or nothing where neither condition varies.
  std::optional<double> d_av;
  /// d_z times Hedges' correction for few subjects, 1 - 3 / (4 df - 1); nothing for two subjects.
  std::optional<double> g_z;
};

/// Two values per subject, at least two subjects, in the same order.
PairedT TestPair(std::span<const double> first, std::span<const double> second, double alpha);

}  // namespace conav::statistics
