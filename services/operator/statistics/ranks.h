#pragma once

#include <span>
#include <vector>

namespace conav::statistics {

struct Ranks {
  std::vector<double> ranks;  // 1 for the smallest; equal values share the mean of their ranks
  double tie_sum = 0.0;       // of t^3 - t over the groups of t equal values
};

/// Values closer than `error` are equal.
Ranks RankValues(std::span<const double> values, double error);

}  // namespace conav::statistics
