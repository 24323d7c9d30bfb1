#include "operator/statistics/shapiro_wilk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "operator/statistics/distributions.h"
#include "operator/statistics/moments.h"

namespace conav::statistics {
namespace {

// Royston's fitted coefficients, constant term first.
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

/// Of the upper half, largest first; the lower half has the same ones with a minus.
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
  const std::size_t fitted = n > 5 ? 2 : 1;  // weights that a polynomial gives
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
  if (n == 3) {  // known exactly; W is at least 3/4
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

}  // namespace

std::optional<ShapiroWilk> TestNormality(std::span<const double> values, double error) {
  if (values.size() < 3 || values.size() > kMostShapiroValues) return std::nullopt;
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  if (sorted.back() - sorted.front() <= error) return std::nullopt;
  const double w = Statistic(sorted);
  return ShapiroWilk{w, Probability(w, sorted.size())};
}

}  // namespace conav::statistics
