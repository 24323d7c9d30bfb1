#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "study/statistics/moments.h"
#include "unit/study/statistics/reference_tables.h"

namespace conav::statistics {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST_CASE("Tails where they have a closed form", "[operator][statistics]") {
  CHECK(StudentTwoSided(1.0, 1.0) == Near(0.5));  // Cauchy
  CHECK(StudentTwoSided(-1.0, 1.0) == Near(0.5));
  CHECK(ChiSquaredUpper(3.0, 2.0) == Near(std::exp(-1.5)));
  CHECK(FisherUpper(1.0, 5.0, 5.0) == Near(0.5));
  CHECK(FisherUpper(3.0, 2.0, 4.0) == Near(0.16));  // (1 + 2 F / 4)^-2
  CHECK(NormalUpper(0.0) == 0.5);
}

TEST_CASE("Quantiles turn tails around", "[operator][statistics]") {
  CHECK(StudentTwoSided(StudentQuantile(0.975, 8.0), 8.0) == Near(0.05));
  CHECK(NormalUpper(NormalQuantile(0.3)) == Near(0.7));
}

TEST_CASE("Nothing lies beyond infinity", "[operator][statistics]") {
  CHECK(StudentTwoSided(-kInfinity, 3.0) == 0.0);
  CHECK(FisherUpper(kInfinity, 2.0, 3.0) == 0.0);
  CHECK(ChiSquaredUpper(kInfinity, 2.0) == 0.0);
  CHECK(NormalUpper(kInfinity) == 0.0);
  CHECK(NormalUpper(-kInfinity) == 1.0);
  CHECK(StudentTwoSided(1e200, 3.0) == 0.0);
}

}  // namespace
}  // namespace conav::statistics
