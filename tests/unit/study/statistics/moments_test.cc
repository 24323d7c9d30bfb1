#include "study/statistics/moments.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "unit/study/statistics/reference_tables.h"

namespace conav::statistics {
namespace {

using Values = std::vector<double>;

TEST_CASE("Mean, median, variance and magnitude by hand, one value does not vary", "[statistics]") {
  const std::vector<double> values{4, 1, -7, 2};
  CHECK(Mean(values) == 0.0);
  CHECK(Median(values) == 1.5);
  CHECK(Median(std::vector<double>{3, 1, 2}) == 2.0);
  CHECK(SquaredDeviations(values) == 70.0);
  CHECK(Variance(values) == Approx(70.0 / 3.0));
  CHECK(Magnitude(values) == 7.0);
  CHECK(Variance(std::vector<double>{3}) == 0.0);
  CHECK(Variance(std::vector<double>{0.1, 0.1, 0.1}) == 0.0);  // of which the mean is rounded
  CHECK(StandardDeviation(std::vector<double>{0.3 - 0.2, 0.2 - 0.1, 0.1}) == 0.0);
}

TEST_CASE("Equal values share the mean of their ranks", "[statistics]") {
  const Ranks ranks = RankValues(Values{5, 1, 5, 2, 5, 1}, 0.0);
  CHECK(ranks.ranks == Values{5, 1.5, 5, 3, 5, 1.5});
  CHECK(ranks.tie_sum == 24.0 + 6.0);
  // Apart by rounding errors only.
  CHECK(RankValues(Values{0.3 - 0.2, 0.2 - 0.1, 0.5}, 1e-15).ranks == Values{1.5, 1.5, 3});
  CHECK(RankValues(Values{}, 0.0).ranks.empty());
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST_CASE("Nothing lies beyond infinity", "[statistics]") {
  CHECK(StudentTwoSided(-kInfinity, 3.0) == 0.0);
  CHECK(FisherUpper(kInfinity, 2.0, 3.0) == 0.0);
  CHECK(ChiSquaredUpper(kInfinity, 2.0) == 0.0);
  CHECK(NormalUpper(kInfinity) == 0.0);
  CHECK(NormalUpper(-kInfinity) == 1.0);
  CHECK(StudentTwoSided(1e200, 3.0) == 0.0);
}

}  // namespace
}  // namespace conav::statistics
