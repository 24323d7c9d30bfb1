#include "operator/statistics/distributions.h"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

namespace conav::statistics {

using boost::math::cdf;
using boost::math::complement;
using boost::math::quantile;

double StudentTwoSided(double t, double df) {
  if (std::isinf(t)) return 0.0;
  return 2.0 * cdf(complement(boost::math::students_t(df), std::abs(t)));
}

double StudentQuantile(double probability, double df) {
  return quantile(boost::math::students_t(df), probability);
}

double FisherUpper(double f, double df1, double df2) {
  if (std::isinf(f)) return 0.0;
  return cdf(complement(boost::math::fisher_f(df1, df2), f));
}

double ChiSquaredUpper(double x, double df) {
  if (std::isinf(x)) return 0.0;
  return cdf(complement(boost::math::chi_squared(df), x));
}

double NormalUpper(double z) {
  if (std::isinf(z)) return z > 0.0 ? 0.0 : 1.0;
  return cdf(complement(boost::math::normal(), z));
}

double NormalQuantile(double probability) { return quantile(boost::math::normal(), probability); }

}  // namespace conav::statistics
