#include <catch2/catch.hpp>
#include <cmath>

#include "study/statistics/pairs.h"
#include "unit/study/statistics/reference_tables.h"

namespace conav::statistics {
namespace {

using Values = std::vector<double>;

/// Some numbers that are the same in R.
Values Numbers(int count) {
  Values values;
  for (int i = 1; i <= count; ++i) {
    values.push_back(std::round(1000.0 * (i * 7919 % 101 / 10.0 + i * (i % 13) / 7.0)) / 1000.0);
  }
  return values;
}

TEST_CASE("W and p are those of R's shapiro.test, for few and many values",
          "[operator][statistics]") {
  struct Expected {
    int count;
    double w, p;
  };
  for (const Expected& expected : {Expected{3, 0.85491435743806543, 0.25368301349234712},
                                   Expected{4, 0.80766132872461005, 0.11668471473024349},
                                   Expected{5, 0.77001744790987492, 0.045132744738391115},
                                   Expected{6, 0.80265447475857066, 0.062088195246888127},
                                   Expected{11, 0.94050654458074556, 0.52647154067473168},
                                   Expected{12, 0.92752095382836564, 0.35457528049634723},
                                   Expected{30, 0.90723186990027094, 0.012679206792055333},
                                   Expected{60, 0.92044478595450741, 0.0007992079627158553},
                                   Expected{200, 0.89486382526538866, 1.1980067191884346e-10}}) {
    const auto test = TestNormality(Numbers(expected.count), 0.0);
    INFO(expected.count);
    REQUIRE(test);
    CHECK(test->w == Near(expected.w));
    CHECK(test->p == Near(expected.p));
  }
}

TEST_CASE("Two, too many and equal values cannot be tested", "[operator][statistics]") {
  CHECK_FALSE(TestNormality(Values{1, 2}, 0.0));
  CHECK_FALSE(TestNormality(Numbers(5001), 0.0));
  CHECK(TestNormality(Numbers(5000), 0.0));
  CHECK_FALSE(TestNormality(Values{0.3 - 0.2, 0.2 - 0.1, 0.1}, 1e-15));
}

TEST_CASE("Evenly spaced values of three are as normal as can be, two equal ones as little",
          "[operator][statistics]") {
  CHECK(TestNormality(Values{1, 2, 3}, 0.0)->p == Near(1.0));
  CHECK(TestNormality(Values{1, 1, 3}, 0.0)->p < 1e-7);
}

}  // namespace
}  // namespace conav::statistics
