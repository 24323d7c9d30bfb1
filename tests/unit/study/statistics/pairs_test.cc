#include "study/statistics/pairs.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <sstream>

#include "unit/study/statistics/reference_tables.h"

namespace conav::statistics {
namespace {

using Row = std::vector<std::string>;

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

TEST_CASE("All pairs of the reference data are R's, in every column", "[operator][statistics]") {
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

// wilcox.test(paired = TRUE) and shapiro.test of the differences of obk_phase.
TEST_CASE("Every pair has Wilcoxon's and Shapiro's test", "[operator][statistics]") {
  const std::vector<Pair> pairs = ComparePairs(ReferenceTable("obk_phase"), 0.05);
  REQUIRE(pairs.size() == 3);
  CHECK(*pairs[0].wilcoxon.v == 73.5);
  CHECK(*pairs[0].wilcoxon.p == Near(0.042417977250439755));
  CHECK(*pairs[1].wilcoxon.p == Near(0.0019162585046794466));
  CHECK(*pairs[2].wilcoxon.p == Near(0.011207215431226278));
  CHECK(*pairs[1].wilcoxon_adjusted.bonferroni == Near(3 * 0.0019162585046794466));
  CHECK(*pairs[2].wilcoxon_adjusted.holm == Near(2 * 0.011207215431226278));
  CHECK(pairs[0].normality->w == Near(0.82325019756254769));
  CHECK(pairs[0].normality->p == Near(0.0056404248126930524));
  CHECK(pairs[2].normality->p == Near(0.27180909147460597));
}

TEST_CASE("A pair without p does not count for the others", "[operator][statistics]") {
  const std::vector<Pair> pairs =
      ComparePairs(MakeTable({"a", "b", "c"}, {1, 1, 4, 2, 2, 3, 3, 3, 9}), 0.05);
  CHECK_FALSE(pairs[0].t_adjusted.holm);
  CHECK(*pairs[1].t_adjusted.bonferroni == Near(2 * *pairs[1].t.p));
}

}  // namespace
}  // namespace conav::statistics
