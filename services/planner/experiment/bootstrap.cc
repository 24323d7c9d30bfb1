#include "planner/experiment/bootstrap.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "common/runtime/random.h"

namespace conav::planner {

double Mean(std::span<const double> values) {
  if (values.empty()) return 0.0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

Interval BootstrapMean(std::span<const double> values, std::uint64_t seed, int draws) {
  if (values.empty()) return {};
  Random random(seed);
  const auto last = static_cast<std::int64_t>(values.size()) - 1;
  std::vector<double> means;
  for (int draw = 0; draw < draws; ++draw) {
    double sum = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      sum += values[static_cast<std::size_t>(random.Uniform(0, last))];
    }
    means.push_back(sum / static_cast<double>(values.size()));
  }
  std::sort(means.begin(), means.end());
  const auto at = [&](double share) {
    return means[static_cast<std::size_t>(share * static_cast<double>(means.size() - 1))];
  };
  return {at(0.025), at(0.975)};
}

}  // namespace conav::planner
