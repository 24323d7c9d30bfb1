#include <algorithm>
#include <cmath>
#include <vector>

#include "common/runtime/random.h"
#include "study/statistics/analysis.h"

namespace conav::statistics {
namespace {

/// Sufficient statistics of paired values.
struct PairedSums {
  double n = 0.0;
  double mean_x = 0.0, mean_y = 0.0;
  double var_x = 0.0, var_y = 0.0, cov = 0.0;
};

PairedSums SumsOf(std::span<const double> x, std::span<const double> y) {
  PairedSums sums{static_cast<double>(x.size()), Mean(x), Mean(y), Variance(x), Variance(y)};
  for (std::size_t i = 0; i < x.size(); ++i) {
    sums.cov += (x[i] - sums.mean_x) * (y[i] - sums.mean_y) / (sums.n - 1.0);
  }
  return sums;
}

/// t of the hypothesis that the mean of x - ratio y is 0; infinite without spread.
double TOfRatio(const PairedSums& sums, double ratio) {
  const double variance = sums.var_x - 2.0 * ratio * sums.cov + ratio * ratio * sums.var_y;
  const double error = std::sqrt(std::max(0.0, variance) / sums.n);
  const double difference = sums.mean_x - ratio * sums.mean_y;
  const double magnitude = std::max(std::abs(sums.mean_x), std::abs(sums.mean_y));
  if (error <= RoundingError(magnitude)) {
    return std::abs(difference) <= RoundingError(magnitude) ? 0.0 : difference * HUGE_VAL;
  }
  return difference / error;
}

/// The smaller t of both one-sided tests.
double SmallerT(const PairedSums& sums, double margin) {
  return std::min(TOfRatio(sums, 1.0 - margin), -TOfRatio(sums, 1.0 + margin));
}

/// The ratios with |t| <= `t`: the roots of a quadratic equation, finite where the baseline's mean is
/// not 0 beyond doubt. Fieller, 1954.
std::optional<Interval> FiellerInterval(const PairedSums& sums, double t) {
  const double factor = t * t / sums.n;
  const double a = sums.mean_y * sums.mean_y - factor * sums.var_y;
  const double b = sums.mean_x * sums.mean_y - factor * sums.cov;
  const double c = sums.mean_x * sums.mean_x - factor * sums.var_x;
  if (a <= 0.0) return std::nullopt;
  const double root = std::sqrt(std::max(0.0, b * b - a * c));
  return Interval{(b - root) / a, (b + root) / a};
}

constexpr int kPowerDraws = 2000;

double PowerWith(int subjects, const PairedSums& observed, double margin, double alpha) {
  Random random(1);
  const double t = StudentQuantile(1.0 - alpha, subjects - 1.0);
  const double slope = observed.var_y > 0.0 ? observed.cov / observed.var_y : 0.0;
  const double rest = std::sqrt(std::max(0.0, observed.var_x - slope * observed.cov));
  std::vector<double> x(static_cast<std::size_t>(subjects));
  std::vector<double> y(x.size());
  int shown = 0;
  for (int draw = 0; draw < kPowerDraws; ++draw) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double level = std::sqrt(observed.var_y) * DrawNormal(random);
      y[i] = observed.mean_y + level;
      x[i] = observed.mean_y + slope * level + rest * DrawNormal(random);
    }
    if (SmallerT(SumsOf(x, y), margin) > t) ++shown;
  }
  return static_cast<double>(shown) / kPowerDraws;
}

}  // namespace

Equivalence TestEquivalence(std::span<const double> first, std::span<const double> second,
                            double margin, double alpha) {
  const PairedSums sums = SumsOf(first, second);
  const double df = sums.n - 1.0;
  const double t = SmallerT(sums, margin);
  const double two_sided = StudentTwoSided(t, df);
  Equivalence result{.margin = margin,
                     .ratio = sums.mean_x / sums.mean_y,
                     .interval = FiellerInterval(sums, StudentQuantile(1.0 - alpha, df)),
                     .p = t > 0.0 ? 0.5 * two_sided : 1.0 - 0.5 * two_sided};
  result.is_shown = result.p < alpha;
  return result;
}

std::optional<int> SubjectsForEquivalence(std::span<const double> first,
                                          std::span<const double> second, double margin,
                                          double alpha) {
  const PairedSums observed = SumsOf(first, second);
  return FewestSubjects(
      [&](int subjects) { return PowerWith(subjects, observed, margin, alpha) >= kPower; });
}

void AddEquivalence(Analysis& analysis, double margin, bool with_power, const std::string& only) {
  const ConditionTable& table = analysis.table;
  auto pair = analysis.pairs.begin();
  for (std::size_t a = 0; a < table.condition_count(); ++a) {
    for (std::size_t b = a + 1; b < table.condition_count(); ++b, ++pair) {
      if (!only.empty() && pair->first != only) continue;
      const std::vector<double> first = ConditionValues(table, a);
      const std::vector<double> second = ConditionValues(table, b);
      pair->equivalence = TestEquivalence(first, second, margin, analysis.alpha);
      if (!with_power) continue;
      pair->equivalence->subjects = SubjectsForEquivalence(first, second, margin, analysis.alpha);
    }
  }
}

}  // namespace conav::statistics
