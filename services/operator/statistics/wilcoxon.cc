#include "operator/statistics/wilcoxon.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "operator/statistics/distributions.h"
#include "operator/statistics/moments.h"
#include "operator/statistics/ranks.h"

namespace conav::statistics {
namespace {

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

}  // namespace

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

}  // namespace conav::statistics
