#include "operator/statistics/paired_t.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "operator/statistics/distributions.h"
#include "operator/statistics/moments.h"

namespace conav::statistics {
namespace {

/// `difference` in units of `spread`; infinite or nothing where nothing spreads. `error` is what
/// rounding may do to both.
std::optional<double> InUnitsOf(double spread, double difference, double error) {
  if (spread > error) return difference / spread;
  if (std::abs(difference) <= error) return std::nullopt;
  return std::copysign(std::numeric_limits<double>::infinity(), difference);
}

}  // namespace

PairedT TestPair(std::span<const double> first, std::span<const double> second, double alpha) {
  std::vector<double> differences;
  for (std::size_t i = 0; i < first.size(); ++i) differences.push_back(first[i] - second[i]);
  const double error = RoundingError(std::max(Magnitude(first), Magnitude(second)));
  const auto n = static_cast<double>(first.size());
  double spread = StandardDeviation(differences);
  if (spread <= error) spread = 0.0;
  PairedT test{.mean_difference = Mean(differences), .df = n - 1.0};
  test.interval = StudentInterval(test.mean_difference, spread / std::sqrt(n), test.df, alpha);
  test.d_z = InUnitsOf(spread, test.mean_difference, error);
  test.d_av =
      InUnitsOf(std::sqrt(0.5 * (Variance(first) + Variance(second))), test.mean_difference, error);
  if (test.d_z) {
    test.t = *test.d_z * std::sqrt(n);
    test.p = StudentTwoSided(*test.t, test.df);
    if (test.df > 1.0) test.g_z = *test.d_z * (1.0 - 3.0 / (4.0 * test.df - 1.0));
  }
  return test;
}

}  // namespace conav::statistics
