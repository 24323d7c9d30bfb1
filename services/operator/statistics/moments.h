#pragma once

#include <span>

namespace conav::statistics {

/// None of these is asked for no values.
double Mean(std::span<const double> values);
double Median(std::span<const double> values);

/// Sum of squared distances from the mean.
double SquaredDeviations(std::span<const double> values);

/// Divided by n - 1; 0 for one value, and where all are equal but for rounding errors.
double Variance(std::span<const double> values);
double StandardDeviation(std::span<const double> values);

/// The largest absolute value.
double Magnitude(std::span<const double> values);

/// Differences this small between numbers of `magnitude` are rounding errors: 0.3 - 0.2 and
/// 0.2 - 0.1 are one value. What spreads less than this does not vary.
double RoundingError(double magnitude);

}  // namespace conav::statistics
