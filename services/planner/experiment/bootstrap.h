#pragma once

#include <cstdint>
#include <span>

namespace conav::planner {

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// 95 % percentile bootstrap interval of the mean: `draws` resamples of `values` with replacement.
/// Seeded: equal arguments give equal intervals. Of no values {0, 0}.
/// Source: Efron and Tibshirani, An Introduction to the Bootstrap, chapter 13.
Interval BootstrapMean(std::span<const double> values, std::uint64_t seed, int draws = 2000);

double Mean(std::span<const double> values);  // 0 of none

}  // namespace conav::planner
