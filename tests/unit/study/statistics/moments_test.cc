#include "study/statistics/moments.h"

#include <catch2/catch.hpp>
#include <vector>

namespace conav::statistics {
namespace {

TEST_CASE("Mean, median, variance and magnitude by hand", "[operator][statistics]") {
  const std::vector<double> values{4, 1, -7, 2};
  CHECK(Mean(values) == 0.0);
  CHECK(Median(values) == 1.5);
  CHECK(Median(std::vector<double>{3, 1, 2}) == 2.0);
  CHECK(SquaredDeviations(values) == 70.0);
  CHECK(Variance(values) == Approx(70.0 / 3.0));
  CHECK(Magnitude(values) == 7.0);
}

TEST_CASE("One value does not vary, nor do equal ones whose mean is rounded",
          "[operator][statistics]") {
  CHECK(Variance(std::vector<double>{3}) == 0.0);
  CHECK(Variance(std::vector<double>{0.1, 0.1, 0.1}) == 0.0);
  CHECK(StandardDeviation(std::vector<double>{0.3 - 0.2, 0.2 - 0.1, 0.1}) == 0.0);
}

}  // namespace
}  // namespace conav::statistics
