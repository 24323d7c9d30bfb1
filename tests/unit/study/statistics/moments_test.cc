#include "study/statistics/moments.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "unit/study/statistics/reference_tables.h"

namespace conav::statistics {
namespace {

using Values = std::vector<double>;

TEST_CASE("Mean, median, variance and magnitude by hand", "[statistics]") {
  const std::vector<double> values{4, 1, -7, 2};
  CHECK(Mean(values) == 0.0);
  CHECK(Median(values) == 1.5);
  CHECK(Median(std::vector<double>{3, 1, 2}) == 2.0);
  CHECK(SquaredDeviations(values) == 70.0);
  CHECK(Variance(values) == Approx(70.0 / 3.0));
  CHECK(Magnitude(values) == 7.0);
}

TEST_CASE("One value does not vary, nor do equal ones whose mean is rounded", "[statistics]") {
  CHECK(Variance(std::vector<double>{3}) == 0.0);
  CHECK(Variance(std::vector<double>{0.1, 0.1, 0.1}) == 0.0);
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

TEST_CASE("Tails where they have a closed form", "[statistics]") {
  CHECK(StudentTwoSided(1.0, 1.0) == Near(0.5));  // Cauchy
  CHECK(StudentTwoSided(-1.0, 1.0) == Near(0.5));
  CHECK(ChiSquaredUpper(3.0, 2.0) == Near(std::exp(-1.5)));
  CHECK(FisherUpper(1.0, 5.0, 5.0) == Near(0.5));
  CHECK(FisherUpper(3.0, 2.0, 4.0) == Near(0.16));  // (1 + 2 F / 4)^-2
  CHECK(NormalUpper(0.0) == 0.5);
  CHECK(StudentTwoSided(StudentQuantile(0.975, 8.0), 8.0) == Near(0.05));
  CHECK(NormalUpper(NormalQuantile(0.3)) == Near(0.7));
}

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
