#pragma once

#include <span>
#include <vector>

namespace conav {
class Random;
}

namespace conav::statistics {

/// Level of tests and intervals in the studies.
inline constexpr double kAlpha = 0.05;

/// All of these require at least one value.
double Mean(std::span<const double> values);
double Median(std::span<const double> values);

/// Sum of squared distances from the mean.
double SquaredDeviations(std::span<const double> values);

/// Divided by n - 1; 0 for one value, and if all are equal except for rounding errors.
double Variance(std::span<const double> values);
double StandardDeviation(std::span<const double> values);

/// The largest absolute value.
double Magnitude(std::span<const double> values);

/// Smaller differences between numbers of `magnitude` are rounding errors: 0.3 - 0.2 and
/// 0.2 - 0.1 are one value. Values with less spread do not vary.
double RoundingError(double magnitude);

// Tail probabilities and quantiles. Degrees of freedom are above 0 and need not be whole; a
// statistic may be infinite.

/// P(|T| >= |t|) of Student's t.
double StudentTwoSided(double t, double df);
/// The t with P(T <= t) = probability, in (0, 1).
double StudentQuantile(double probability, double df);
/// P(F' >= f) of Fisher's F.
double FisherUpper(double f, double df1, double df2);
/// P(X >= x) of chi squared.
double ChiSquaredUpper(double x, double df);
/// P(Z >= z) of the standard normal distribution.
double NormalUpper(double z);
/// The z with P(Z <= z) = probability, in (0, 1).
double NormalQuantile(double probability);

/// A draw of the standard normal distribution; Marsaglia's polar method.
double DrawNormal(Random& random);

struct Ranks {
  std::vector<double> ranks;  // 1 for the smallest; equal values share the mean of their ranks
  double tie_sum = 0.0;       // of t^3 - t over the groups of t equal values
};

/// Values closer than `error` are equal.
Ranks RankValues(std::span<const double> values, double error);

/// A confidence interval.
struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// `middle` -+ t(df, 1 - alpha / 2) `standard_error`.
Interval StudentInterval(double middle, double standard_error, double df, double alpha);

}  // namespace conav::statistics
