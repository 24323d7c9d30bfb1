#include "operator/statistics/interval.h"

#include "operator/statistics/distributions.h"

namespace conav::statistics {

Interval StudentInterval(double middle, double standard_error, double df, double alpha) {
  const double reach = StudentQuantile(1.0 - alpha / 2.0, df) * standard_error;
  return {middle - reach, middle + reach};
}

}  // namespace conav::statistics
