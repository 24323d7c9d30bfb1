#pragma once

/// Tail probabilities and quantiles of the distributions that tests need. Degrees of freedom are
/// above 0 and need not be whole; a statistic may be infinite.
namespace conav::statistics {

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

}  // namespace conav::statistics
