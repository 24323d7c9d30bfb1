#include <catch2/catch.hpp>
#include <cmath>

#include "common/runtime/random.h"
#include "study/experiment/search_experiment.h"

namespace conav::planner {
namespace {

TEST_CASE("the interval of equal values is that value", "[planner][experiment]") {
  const std::vector<double> values(10, 3.0);
  const Interval interval = BootstrapMean(values, 1);
  CHECK(interval.low == 3.0);
  CHECK(interval.high == 3.0);
}

TEST_CASE("the interval is about two standard errors wide each way", "[planner][experiment]") {
  Random random(7);
  std::vector<double> values;
  for (int i = 0; i < 400; ++i) values.push_back(random.Unit());
  const double mean = Mean(values);
  const double error = std::sqrt(1.0 / 12.0 / 400.0);
  const Interval interval = BootstrapMean(values, 1);
  CHECK(interval.low == Approx(mean - 1.96 * error).margin(0.2 * error));
  CHECK(interval.high == Approx(mean + 1.96 * error).margin(0.2 * error));
}

TEST_CASE("equal seeds give equal intervals, no values none", "[planner][experiment]") {
  const std::vector<double> values{1.0, 5.0, 2.0, 8.0};
  CHECK(BootstrapMean(values, 3).low == BootstrapMean(values, 3).low);
  CHECK(BootstrapMean({}, 3).high == 0.0);
  CHECK(Mean({}) == 0.0);
}

}  // namespace
}  // namespace conav::planner
