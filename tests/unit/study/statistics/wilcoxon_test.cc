#include <catch2/catch.hpp>

#include "study/statistics/pairs.h"
#include "unit/study/statistics/reference_tables.h"

namespace conav::statistics {
namespace {

using Values = std::vector<double>;

// One difference is 0, two are -1.3 up to rounding.
TEST_CASE("Wilcoxon's test of sleep is R's, by the normal distribution", "[operator][statistics]") {
  const ConditionTable sleep = SleepTable();
  const Wilcoxon test = TestSignedRanks(ConditionValues(sleep, 0), ConditionValues(sleep, 1));
  CHECK_FALSE(test.exact);
  CHECK(test.used == 9);
  CHECK(*test.v == 0.0);
  CHECK(*test.p == Near(0.0090906980159250559));
}

TEST_CASE("Signed ranks with ties and zeros are R's", "[operator][statistics]") {
  const ConditionTable table = ReferenceTable("ergoStool");
  const Wilcoxon test = TestSignedRanks(ConditionValues(table, 0), ConditionValues(table, 3));
  CHECK(*test.v == 9.5);
  CHECK(*test.p == Near(0.25430596599062305));
}

/// Pairs of conditions without ties, the same in R.
Wilcoxon TestMade(int count) {
  const Values cycle{40, 3, 30};
  Values first;
  Values second;
  for (int i = 1; i <= count; ++i) {
    first.push_back(i + 0.01 * i * i);
    second.push_back(cycle[static_cast<std::size_t>((i - 1) % 3)] + 0.317 * i);
  }
  return TestSignedRanks(first, second);
}

TEST_CASE("Without ties and zeros p is exact, and R's", "[operator][statistics]") {
  const Wilcoxon test =
      TestSignedRanks(Values{1.5, 2.3, 0.2, 4.4, 3.1, 5.9, 2.2, 7.7, 6.1, 0.9, 1.1, 8.3},
                      Values{1.1, 2.9, 0.9, 5.6, 2.9, 6.4, 4.2, 9.9, 6.75, 2.2, 1.69, 6.6});
  CHECK(test.exact);
  CHECK(*test.v == 13.0);
  CHECK(*test.p == Near(0.042480468750000028));
}

TEST_CASE("From 50 differences on p is that of the normal distribution", "[operator][statistics]") {
  const Wilcoxon exact = TestMade(49);
  CHECK(exact.exact);
  CHECK(*exact.v == 620.0);
  CHECK(*exact.p == Near(0.94499248756896048));
  const Wilcoxon normal = TestMade(50);
  CHECK_FALSE(normal.exact);
  CHECK(*normal.v == 670.0);
  CHECK(*normal.p == Near(0.75739385594691577));
}

TEST_CASE("Few subjects by hand: all of one sign is one signing of 2^n at each end",
          "[operator][statistics]") {
  const Wilcoxon test = TestSignedRanks(Values{1, 2, 3, 4}, Values{0, 0, 0, 0});
  CHECK(test.exact);
  CHECK(*test.v == 10.0);
  CHECK(*test.p == Near(2.0 / 16.0));
  CHECK(*TestSignedRanks(Values{1, -2, -3, 4}, Values{0, 0, 0, 0}).p == 1.0);
}

TEST_CASE("Conditions that are equal up to rounding leave no signed ranks",
          "[operator][statistics]") {
  const Wilcoxon test = TestSignedRanks(Values{0.3, 5}, Values{0.1 + 0.2, 5});
  CHECK(test.used == 0);
  CHECK_FALSE(test.v);
  CHECK_FALSE(test.p);
}

}  // namespace
}  // namespace conav::statistics
