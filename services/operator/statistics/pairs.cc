#include "operator/statistics/pairs.h"

#include <algorithm>

#include "operator/statistics/moments.h"

namespace conav::statistics {
namespace {

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
