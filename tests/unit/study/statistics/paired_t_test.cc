#include <catch2/catch.hpp>
#include <cmath>

#include "study/statistics/pairs.h"
#include "unit/study/statistics/reference_tables.h"

namespace conav::statistics {
namespace {

using Values = std::vector<double>;

TEST_CASE("The paired t test of sleep is R's", "[operator][statistics]") {
  const ConditionTable sleep = SleepTable();
  const PairedT test = TestPair(ConditionValues(sleep, 0), ConditionValues(sleep, 1), 0.05);
  CHECK(*test.t == Near(-4.0621276833820366));
  CHECK(test.df == 9.0);
  CHECK(*test.p == Near(0.0028328901973842702));
  CHECK(test.interval.low == Near(-2.4598857632769824));
  CHECK(test.interval.high == Near(-0.70011423672301754));
  CHECK(std::abs(*test.d_z + 1.28455756) <= 5e-9);
}

TEST_CASE("Constant differences make t infinite, with the sign of the difference",
          "[operator][statistics]") {
  const PairedT test = TestPair(Values{0.1, 0.2, 0.7}, Values{0.2, 0.3, 0.8}, 0.05);
  CHECK(std::isinf(*test.t));
  CHECK(*test.t < 0.0);
  CHECK(*test.p == 0.0);
  CHECK(std::isinf(*test.d_z));
  CHECK(std::isinf(*test.g_z));
  CHECK(std::isfinite(*test.d_av));
  CHECK(test.interval.low == test.interval.high);
}

TEST_CASE("Equal conditions leave nothing to test", "[operator][statistics]") {
  const PairedT test = TestPair(Values{1, 2, 3}, Values{1, 2, 3}, 0.05);
  CHECK(test.mean_difference == 0.0);
  CHECK_FALSE(test.t);
  CHECK_FALSE(test.p);
  CHECK_FALSE(test.d_z);
  CHECK_FALSE(test.g_z);
  CHECK(*test.d_av == 0.0);
  CHECK(test.interval.high == 0.0);
}

TEST_CASE("Two constant conditions have no spread to measure by", "[operator][statistics]") {
  CHECK(std::isinf(*TestPair(Values{4, 4}, Values{1, 1}, 0.05).d_av));
  CHECK_FALSE(TestPair(Values{4, 4}, Values{4, 4}, 0.05).d_av);
}

TEST_CASE("Two subjects have no correction for few subjects", "[operator][statistics]") {
  const PairedT test = TestPair(Values{1, 2}, Values{2, 5}, 0.05);
  CHECK(test.df == 1.0);
  CHECK(*test.t == Near(-2.0));
  CHECK_FALSE(test.g_z);
}

}  // namespace
}  // namespace conav::statistics
