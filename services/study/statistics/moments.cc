#include "study/statistics/moments.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/runtime/random.h"

namespace conav::statistics {

double Mean(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double Median(std::span<const double> values) {
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const std::size_t half = sorted.size() / 2;
  return sorted.size() % 2 == 1 ? sorted[half] : 0.5 * (sorted[half - 1] + sorted[half]);
}

double SquaredDeviations(std::span<const double> values) {
  const double mean = Mean(values);
  double sum = 0.0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return sum;
}

double Variance(std::span<const double> values) {
  if (values.size() < 2) return 0.0;
  const double variance = SquaredDeviations(values) / static_cast<double>(values.size() - 1);
  return std::sqrt(variance) > RoundingError(Magnitude(values)) ? variance : 0.0;
}

double StandardDeviation(std::span<const double> values) { return std::sqrt(Variance(values)); }

double Magnitude(std::span<const double> values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

double RoundingError(double magnitude) {
  return 16.0 * std::numeric_limits<double>::epsilon() * magnitude;
}

using boost::math::cdf;
using boost::math::complement;
using boost::math::quantile;

double StudentTwoSided(double t, double df) {
  if (std::isinf(t)) return 0.0;
  return 2.0 * cdf(complement(boost::math::students_t(df), std::abs(t)));
}

double StudentQuantile(double probability, double df) {
  return quantile(boost::math::students_t(df), probability);
}

double FisherUpper(double f, double df1, double df2) {
  if (std::isinf(f)) return 0.0;
  return cdf(complement(boost::math::fisher_f(df1, df2), f));
}

double ChiSquaredUpper(double x, double df) {
  if (std::isinf(x)) return 0.0;
  return cdf(complement(boost::math::chi_squared(df), x));
}

double NormalUpper(double z) {
  if (std::isinf(z)) return z > 0.0 ? 0.0 : 1.0;
  return cdf(complement(boost::math::normal(), z));
}

double NormalQuantile(double probability) { return quantile(boost::math::normal(), probability); }

double DrawNormal(Random& random) {
  while (true) {
    const double u = 2.0 * random.Unit() - 1.0;
    const double v = 2.0 * random.Unit() - 1.0;
    const double s = u * u + v * v;
    if (s > 0.0 && s < 1.0) return u * std::sqrt(-2.0 * std::log(s) / s);
  }
}

Ranks RankValues(std::span<const double> values, double error) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [values](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  Ranks result{std::vector<double>(values.size()), 0.0};
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    end = begin + 1;
    while (end < order.size() && values[order[end]] - values[order[end - 1]] <= error) ++end;
    const auto tied = static_cast<double>(end - begin);
    for (std::size_t i = begin; i < end; ++i) {
      result.ranks[order[i]] = static_cast<double>(begin) + (tied + 1.0) / 2.0;
    }
    result.tie_sum += tied * tied * tied - tied;
  }
  return result;
}

Interval StudentInterval(double middle, double standard_error, double df, double alpha) {
  const double reach = StudentQuantile(1.0 - alpha / 2.0, df) * standard_error;
  return {middle - reach, middle + reach};
}

}  // namespace conav::statistics
