#include "operator/statistics/ranks.h"

#include <algorithm>
#include <numeric>

namespace conav::statistics {

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

}  // namespace conav::statistics
