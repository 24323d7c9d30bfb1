#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "study/statistics/analysis.h"

namespace conav::statistics {
namespace {

// Shapiro-Wilk: Royston's fitted coefficients, constant term first.
constexpr std::array kLargestWeight{0.0, 0.221157, -0.147981, -2.07119, 4.434685, -2.706056};
constexpr std::array kSecondWeight{0.0, 0.042981, -0.293762, -1.752461, 5.682633, -3.582633};
constexpr std::array kSmallBound{-2.273, 0.459};
constexpr std::array kSmallMean{0.544, -0.39978, 0.025054, -6.714e-4};
constexpr std::array kSmallLogDeviation{1.3822, -0.77857, 0.062767, -0.0020322};
constexpr std::array kLargeMean{-1.5861, -0.31082, -0.083751, 0.0038915};
constexpr std::array kLargeLogDeviation{-0.4803, -0.082676, 0.0030302};
constexpr std::size_t kLargestSmall = 11;  // samples up to this size use the "small" fits

double Polynomial(std::span<const double> coefficients, double x) {
  double sum = 0.0;
  for (std::size_t i = coefficients.size(); i-- > 0;) sum = sum * x + coefficients[i];
  return sum;
}

/// Weights of the upper half, largest first; the lower half has the same ones with a minus.
std::vector<double> Weights(std::size_t n) {
  if (n == 3) return {std::sqrt(0.5)};
  const auto count = static_cast<double>(n);
  std::vector<double> scores;  // expected normal order statistics, Blom's approximation
  double squares = 0.0;        // of all n
  for (std::size_t i = 1; i <= n / 2; ++i) {
    scores.push_back(-NormalQuantile((static_cast<double>(i) - 0.375) / (count + 0.25)));
    squares += 2.0 * scores.back() * scores.back();
  }
  const double x = 1.0 / std::sqrt(count);
  const std::size_t fitted = n > 5 ? 2 : 1;  // weights from a polynomial
  std::vector<double> weights{scores[0] / std::sqrt(squares) + Polynomial(kLargestWeight, x)};
  if (fitted == 2) {
    weights.push_back(scores[1] / std::sqrt(squares) + Polynomial(kSecondWeight, x));
  }
  double score_rest = squares;
  double weight_rest = 1.0;  // the squares of all weights add up to 1
  for (std::size_t i = 0; i < fitted; ++i) {
    score_rest -= 2.0 * scores[i] * scores[i];
    weight_rest -= 2.0 * weights[i] * weights[i];
  }
  for (std::size_t i = fitted; i < scores.size(); ++i) {
    weights.push_back(scores[i] * std::sqrt(weight_rest / score_rest));
  }
  return weights;
}

double Statistic(const std::vector<double>& sorted) {
  const std::vector<double> weights = Weights(sorted.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += weights[i] * (sorted[sorted.size() - 1 - i] - sorted[i]);
  }
  return std::min(1.0, sum * sum / SquaredDeviations(sorted));
}

double Probability(double w, std::size_t n) {
  if (n == 3) {  // exact; W is at least 3/4
    const double angle = std::asin(std::sqrt(w)) - std::asin(std::sqrt(0.75));
    return std::clamp(6.0 / std::numbers::pi * angle, 0.0, 1.0);
  }
  const auto count = static_cast<double>(n);
  double y = std::log(1.0 - w);
  if (n > kLargestSmall) {
    const double x = std::log(count);
    return NormalUpper((y - Polynomial(kLargeMean, x)) /
                       std::exp(Polynomial(kLargeLogDeviation, x)));
  }
  const double bound = Polynomial(kSmallBound, count);
  if (y >= bound) return 0.0;
  y = -std::log(bound - y);
  return NormalUpper((y - Polynomial(kSmallMean, count)) /
                     std::exp(Polynomial(kSmallLogDeviation, count)));
}

// The tests of pairs.

/// `difference` in units of `spread`; infinite or empty if there is no spread. `error` bounds the
/// rounding errors of both.
std::optional<double> InUnitsOf(double spread, double difference, double error) {
  if (spread > error) return difference / spread;
  if (std::abs(difference) <= error) return std::nullopt;
  return std::copysign(std::numeric_limits<double>::infinity(), difference);
}

constexpr std::size_t kExactBelow = 50;

/// P(V <= v) for `count` untied ranks: of the 2^count ways to sign them, those with a sum of at
/// most v. V is symmetric about its mean.
double LowerTail(double v, std::size_t count) {
  const std::size_t largest = count * (count + 1) / 2;
  std::vector<double> shares(largest + 1);  // of the signings, by their sum
  shares[0] = 1.0;
  for (std::size_t rank = 1; rank <= count; ++rank) {
    for (std::size_t sum = largest + 1; sum-- > 0;) {
      shares[sum] = 0.5 * (shares[sum] + (sum >= rank ? shares[sum - rank] : 0.0));
    }
  }
  double tail = 0.0;
  for (std::size_t sum = 0; static_cast<double>(sum) <= v; ++sum) tail += shares[sum];
  return tail;
}

double ExactP(double v, std::size_t count) {
  const double largest = static_cast<double>(count * (count + 1)) / 2.0;
  return std::min(1.0, 2.0 * LowerTail(std::min(v, largest - v), count));
}

double NormalP(double v, std::size_t count, double tie_sum) {
  const auto n = static_cast<double>(count);
  const double distance = std::abs(v - n * (n + 1.0) / 4.0);
  const double variance = n * (n + 1.0) * (2.0 * n + 1.0) / 24.0 - tie_sum / 48.0;
  return std::min(1.0, 2.0 * NormalUpper(std::max(0.0, distance - 0.5) / std::sqrt(variance)));
}

Pair Compare(const ConditionTable& table, std::size_t a, std::size_t b, double alpha) {
  const std::vector<double> first = ConditionValues(table, a);
  const std::vector<double> second = ConditionValues(table, b);
  std::vector<double> differences;
  for (std::size_t i = 0; i < first.size(); ++i) differences.push_back(first[i] - second[i]);
  const double error = RoundingError(std::max(Magnitude(first), Magnitude(second)));
  return {.first = table.conditions[a],
          .second = table.conditions[b],
          .t = TestPair(first, second, alpha),
          .wilcoxon = TestSignedRanks(first, second),
          .normality = TestNormality(differences, error)};
}

}  // namespace

std::optional<ShapiroWilk> TestNormality(std::span<const double> values, double error) {
  if (values.size() < 3 || values.size() > kMostShapiroValues) return std::nullopt;
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  if (sorted.back() - sorted.front() <= error) return std::nullopt;
  const double w = Statistic(sorted);
  return ShapiroWilk{w, Probability(w, sorted.size())};
}

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

Wilcoxon TestSignedRanks(std::span<const double> first, std::span<const double> second) {
  const double error = RoundingError(std::max(Magnitude(first), Magnitude(second)));
  std::vector<double> differences;
  std::vector<double> sizes;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const double difference = first[i] - second[i];
    if (std::abs(difference) <= error) continue;
    differences.push_back(difference);
    sizes.push_back(std::abs(difference));
  }
  Wilcoxon test{.used = sizes.size()};
  if (sizes.empty()) return test;
  const Ranks ranks = RankValues(sizes, error);
  double v = 0.0;
  for (std::size_t i = 0; i < differences.size(); ++i) {
    if (differences[i] > 0.0) v += ranks.ranks[i];
  }
  test.v = v;
  test.exact = test.used == first.size() && test.used < kExactBelow && ranks.tie_sum == 0.0;
  test.p = test.exact ? ExactP(v, test.used) : NormalP(v, test.used, ranks.tie_sum);
  return test;
}

std::vector<AdjustedP> AdjustForMany(const std::vector<std::optional<double>>& p) {
  std::vector<std::size_t> order;  // the tests with a p, smallest first
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (p[i]) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&p](std::size_t a, std::size_t b) { return *p[a] < *p[b]; });
  const auto m = static_cast<double>(order.size());
  std::vector<AdjustedP> adjusted(p.size());
  double holm = 0.0;
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    const double value = *p[order[rank]];
    holm = std::max(holm, std::min(1.0, (m - static_cast<double>(rank)) * value));
    adjusted[order[rank]].holm = holm;
    adjusted[order[rank]].bonferroni = std::min(1.0, m * value);
  }
  double bh = 1.0;
  for (std::size_t rank = order.size(); rank-- > 0;) {
    bh = std::min(bh, m / static_cast<double>(rank + 1) * *p[order[rank]]);
    adjusted[order[rank]].bh = bh;
  }
  return adjusted;
}

std::vector<Pair> ComparePairs(const ConditionTable& table, double alpha) {
  std::vector<Pair> pairs;
  std::vector<std::optional<double>> t;
  std::vector<std::optional<double>> wilcoxon;
  for (std::size_t a = 0; a < table.condition_count(); ++a) {
    for (std::size_t b = a + 1; b < table.condition_count(); ++b) {
      pairs.push_back(Compare(table, a, b, alpha));
      t.push_back(pairs.back().t.p);
      wilcoxon.push_back(pairs.back().wilcoxon.p);
    }
  }
  const std::vector<AdjustedP> t_adjusted = AdjustForMany(t);
  const std::vector<AdjustedP> wilcoxon_adjusted = AdjustForMany(wilcoxon);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    pairs[i].t_adjusted = t_adjusted[i];
    pairs[i].wilcoxon_adjusted = wilcoxon_adjusted[i];
  }
  return pairs;
}

}  // namespace conav::statistics
