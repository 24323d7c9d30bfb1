#include "operator/statistics/moments.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

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

}  // namespace conav::statistics
