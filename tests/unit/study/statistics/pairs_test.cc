#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "study/statistics/analysis.h"
#include "unit/study/statistics/reference_tables.h"

namespace conav::statistics {
namespace {

using Row = std::vector<std::string>;
using Values = std::vector<double>;

/// The rows of oracle_<name>_pairs.csv; the first is its header.
std::vector<Row> ReadPairs(const std::string& name) {
  const auto bytes = ReadFile(ReferencePath(name + "_pairs"));
  REQUIRE(bytes);
  std::istringstream lines(*bytes);
  std::vector<Row> rows;
  for (std::string line; std::getline(lines, line);) rows.push_back(*SplitCsvRow(line));
  return rows;
}

/// In the order of the reference's columns after the pair's name.
std::vector<double> Figures(const Pair& pair) {
  return {*pair.t.t,
          pair.t.df,
          *pair.t.p,
          pair.t.interval.low,
          pair.t.interval.high,
          *pair.t.d_z,
          *pair.t.d_av,
          *pair.t.g_z,
          *pair.t_adjusted.holm,
          *pair.t_adjusted.bonferroni,
          *pair.t_adjusted.bh};
}

TEST_CASE("All pairs of the reference data are R's, in every column", "[statistics]") {
  for (const char* name : {"ergoStool", "OBK_pre", "obk_phase"}) {
    const std::vector<Row> rows = ReadPairs(name);
    REQUIRE(rows[0] == Row{"pair", "t", "df", "p", "ci_lo", "ci_hi", "dz", "dav", "gz", "p_holm",
                           "p_bonf", "p_bh"});
    const std::vector<Pair> pairs = ComparePairs(ReferenceTable(name), 0.05);
    REQUIRE(pairs.size() == rows.size() - 1);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const Row& row = rows[i + 1];
      CHECK(pairs[i].first + "-" + pairs[i].second == row[0]);
      const std::vector<double> figures = Figures(pairs[i]);
      for (std::size_t c = 1; c < row.size(); ++c) {
        INFO(name << " " << row[0] << " " << rows[0][c]);
        CHECK(figures[c - 1] == Near(std::stod(row[c])));
      }
    }
  }
}

// scipy 1.10.1: ttest_1samp of x - 0.8 y and 1.2 y - x, alternative "greater"; the interval by brentq
// on its statistic. The number of subjects: numpy, 40,000 studies of
// each size (9: 0.77, 10: 0.83).
TEST_CASE("Equivalence is two one-sided t tests of the ratio, with Fieller's interval",
          "[statistics]") {
  const ConditionTable table = ReferenceTable("ergoStool");
  const Values t1 = ConditionValues(table, 0);
  const Values t4 = ConditionValues(table, 3);
  const Equivalence test = TestEquivalence(t1, t4, 0.2, 0.05);
  CHECK(test.ratio == Near(0.927710843373494));
  CHECK(test.interval->low == Near(0.82086150457764));
  CHECK(test.interval->high == Near(1.04710949719121));
  CHECK(test.p == Near(0.0276409874625431));
  CHECK(test.is_shown);
  CHECK(TestEquivalence(t1, ConditionValues(table, 1), 0.2, 0.05).p == Near(0.994403161359523));
  CHECK_FALSE(TestEquivalence(t1, t4, 0.05, 0.05).is_shown);
  CHECK(SubjectsForEquivalence(t1, t4, 0.2, 0.05).value() == 10);
  CHECK_FALSE(SubjectsForEquivalence(t1, t4, 0.001, 0.05));
  // Equal conditions, without spread or a mean.
  CHECK(TestEquivalence(Values{3, 3}, Values{3, 3}, 0.05, 0.05).p == 0.0);
  CHECK_FALSE(TestEquivalence(Values{0, 0}, Values{0, 0}, 0.05, 0.05).is_shown);
}

// wilcox.test(paired = TRUE) and shapiro.test of the differences of obk_phase.
TEST_CASE("Every pair has Wilcoxon's and Shapiro's test", "[statistics]") {
  const std::vector<Pair> pairs = ComparePairs(ReferenceTable("obk_phase"), 0.05);
  REQUIRE(pairs.size() == 3);
  CHECK(*pairs[0].wilcoxon.v == 73.5);
  CHECK(*pairs[0].wilcoxon.p == Near(0.042417977250439755));
  CHECK(*pairs[1].wilcoxon_adjusted.bonferroni == Near(3 * 0.0019162585046794466));
  CHECK(*pairs[2].wilcoxon_adjusted.holm == Near(2 * 0.011207215431226278));
  CHECK(pairs[0].normality->w == Near(0.82325019756254769));
  CHECK(pairs[0].normality->p == Near(0.0056404248126930524));
}

TEST_CASE("Constant differences make t infinite, equal conditions leave nothing to test",
          "[statistics]") {
  const PairedT constant = TestPair(Values{0.1, 0.2, 0.7}, Values{0.2, 0.3, 0.8}, 0.05);
  CHECK(std::isinf(*constant.t));
  CHECK(*constant.t < 0.0);  // the sign of the difference
  CHECK(*constant.p == 0.0);
  CHECK(std::isinf(*constant.d_z));
  CHECK(std::isinf(*constant.g_z));
  CHECK(std::isfinite(*constant.d_av));
  CHECK(constant.interval.low == constant.interval.high);
  const PairedT equal = TestPair(Values{1, 2, 3}, Values{1, 2, 3}, 0.05);
  CHECK(equal.mean_difference == 0.0);
  CHECK_FALSE(equal.t);
  CHECK_FALSE(equal.p);
  CHECK_FALSE(equal.d_z);
  CHECK_FALSE(equal.g_z);
  CHECK(*equal.d_av == 0.0);
  CHECK(equal.interval.high == 0.0);
  CHECK(std::isinf(*TestPair(Values{4, 4}, Values{1, 1}, 0.05).d_av));  // no spread at all
  CHECK_FALSE(TestPair(Values{4, 4}, Values{4, 4}, 0.05).d_av);
  const PairedT two = TestPair(Values{1, 2}, Values{2, 5}, 0.05);
  CHECK(two.df == 1.0);
  CHECK(*two.t == Near(-2.0));
  CHECK_FALSE(two.g_z);  // no correction for so few subjects
}

// One difference of sleep is 0, two are -1.3 up to rounding.
TEST_CASE("Wilcoxon's test with ties and zeros is R's, by the normal distribution",
          "[statistics]") {
  const ConditionTable sleep = SleepTable();
  const Wilcoxon test = TestSignedRanks(ConditionValues(sleep, 0), ConditionValues(sleep, 1));
  CHECK_FALSE(test.exact);
  CHECK(test.used == 9);
  CHECK(*test.v == 0.0);
  CHECK(*test.p == Near(0.0090906980159250559));
  const ConditionTable stool = ReferenceTable("ergoStool");
  const Wilcoxon other = TestSignedRanks(ConditionValues(stool, 0), ConditionValues(stool, 3));
  CHECK(*other.v == 9.5);
  CHECK(*other.p == Near(0.25430596599062305));
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

TEST_CASE("Without ties and zeros p is exact, and R's, up to 49 differences", "[statistics]") {
  const Wilcoxon test =
      TestSignedRanks(Values{1.5, 2.3, 0.2, 4.4, 3.1, 5.9, 2.2, 7.7, 6.1, 0.9, 1.1, 8.3},
                      Values{1.1, 2.9, 0.9, 5.6, 2.9, 6.4, 4.2, 9.9, 6.75, 2.2, 1.69, 6.6});
  CHECK(test.exact);
  CHECK(*test.v == 13.0);
  CHECK(*test.p == Near(0.042480468750000028));
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
          "[statistics]") {
  const Wilcoxon test = TestSignedRanks(Values{1, 2, 3, 4}, Values{0, 0, 0, 0});
  CHECK(test.exact);
  CHECK(*test.v == 10.0);
  CHECK(*test.p == Near(2.0 / 16.0));
  CHECK(*TestSignedRanks(Values{1, -2, -3, 4}, Values{0, 0, 0, 0}).p == 1.0);
  const Wilcoxon none =
      TestSignedRanks(Values{0.3, 5}, Values{0.1 + 0.2, 5});  // equal but for rounding
  CHECK(none.used == 0);
  CHECK_FALSE(none.v);
  CHECK_FALSE(none.p);
}

/// Some numbers that are the same in R.
Values Numbers(int count) {
  Values values;
  for (int i = 1; i <= count; ++i) {
    values.push_back(std::round(1000.0 * (i * 7919 % 101 / 10.0 + i * (i % 13) / 7.0)) / 1000.0);
  }
  return values;
}

TEST_CASE("W and p are those of R's shapiro.test, for few and many values", "[statistics]") {
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

TEST_CASE("Two, too many and equal values cannot be tested", "[statistics]") {
  CHECK_FALSE(TestNormality(Values{1, 2}, 0.0));
  CHECK_FALSE(TestNormality(Numbers(5001), 0.0));
  CHECK(TestNormality(Numbers(5000), 0.0));
  CHECK_FALSE(TestNormality(Values{0.3 - 0.2, 0.2 - 0.1, 0.1}, 1e-15));
  CHECK(TestNormality(Values{1, 2, 3}, 0.0)->p == Near(1.0));  // as normal as can be
  CHECK(TestNormality(Values{1, 1, 3}, 0.0)->p < 1e-7);
}

// R's p.adjust of the same five.
TEST_CASE("Adjusted p are monotone, at most 1, and skip tests without p", "[statistics]") {
  const auto adjusted = AdjustForMany({0.01, 0.04, 0.03, std::nullopt, 0.02, 0.5});
  const std::vector<double> holm{0.05, 0.09, 0.09, 0.0, 0.08, 0.5};
  const std::vector<double> bonferroni{0.05, 0.2, 0.15, 0.0, 0.1, 1.0};
  const std::vector<double> bh{0.05, 0.05, 0.05, 0.0, 0.05, 0.5};
  for (const std::size_t i : {0, 1, 2, 4, 5}) {
    CHECK(*adjusted[i].holm == Near(holm[i]));
    CHECK(*adjusted[i].bonferroni == Near(bonferroni[i]));
    CHECK(*adjusted[i].bh == Near(bh[i]));
  }
  CHECK_FALSE(adjusted[3].holm);
  CHECK_FALSE(adjusted[3].bonferroni);
  CHECK_FALSE(adjusted[3].bh);
  const auto one = AdjustForMany({0.03});
  CHECK(*one[0].holm == 0.03);
  CHECK(*one[0].bonferroni == 0.03);
  CHECK(*one[0].bh == 0.03);
  CHECK(AdjustForMany({}).empty());
}

}  // namespace
}  // namespace conav::statistics
