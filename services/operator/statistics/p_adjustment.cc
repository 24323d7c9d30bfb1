#include "operator/statistics/p_adjustment.h"

#include <algorithm>

namespace conav::statistics {

std::vector<AdjustedP> AdjustForMany(const std::vector<std::optional<double>>& p) {
  std::vector<std::size_t> order;  // the tests that have a p, smallest first
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

}  // namespace conav::statistics
