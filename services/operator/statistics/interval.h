#pragma once

namespace conav::statistics {

/// A confidence interval.
struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// `middle` -+ t(df, 1 - alpha / 2) `standard_error`.
Interval StudentInterval(double middle, double standard_error, double df, double alpha);

}  // namespace conav::statistics
