#include "operator/statistics/friedman.h"

#include <span>

#include "operator/statistics/distributions.h"
#include "operator/statistics/moments.h"
#include "operator/statistics/ranks.h"

namespace conav::statistics {

Friedman TestRanks(const ConditionTable& table) {
  const std::size_t k_count = table.condition_count();
  const auto n = static_cast<double>(table.subject_count());
  const auto k = static_cast<double>(k_count);
  std::vector<double> rank_sums(k_count);
  double tie_sum = 0.0;
  for (std::size_t i = 0; i < table.subject_count(); ++i) {
    const auto row = std::span(table.values).subspan(i * k_count, k_count);
    const Ranks ranks = RankValues(row, RoundingError(Magnitude(row)));
    for (std::size_t j = 0; j < k_count; ++j) rank_sums[j] += ranks.ranks[j];
    tie_sum += ranks.tie_sum;
  }
  Friedman result{.df = k - 1.0};
  for (const double sum : rank_sums) result.mean_ranks.push_back(sum / n);
  const double denominator = n * k * (k + 1.0) - tie_sum / (k - 1.0);
  if (denominator <= 0.0) return result;
  // The rank sums' mean is n (k + 1) / 2.
  result.chi_squared = 12.0 * SquaredDeviations(rank_sums) / denominator;
  result.p = ChiSquaredUpper(*result.chi_squared, result.df);
  result.kendall_w = *result.chi_squared / (n * (k - 1.0));
  return result;
}

}  // namespace conav::statistics
