#include <catch2/catch.hpp>

#include "study/statistics/analysis.h"
#include "unit/study/statistics/reference_tables.h"

namespace conav::statistics {
namespace {

TEST_CASE("Descriptives of ergoStool are R's", "[operator][statistics]") {
  const auto rows = Describe(ReferenceTable("ergoStool"), 0.05);
  REQUIRE(rows.size() == 4);
  const Description& t2 = rows[1];
  CHECK(t2.condition == "T2");
  CHECK(t2.n == 9);
  CHECK(t2.mean == Near(12.4444444444444446));
  CHECK(t2.standard_deviation == Near(1.5898986690282426));
  CHECK(t2.median == 12.0);
  CHECK(t2.mean_interval.high - t2.mean == Near(1.2221043017782423));
  CHECK(t2.mean - t2.mean_interval.low == Near(1.2221043017782423));
  CHECK(rows[0].within_interval.high - rows[0].mean == Near(1.00942740210727200));
  CHECK(rows[1].within_interval.high - rows[1].mean == Near(0.75881865916269930));
  CHECK(rows[2].within_interval.high - rows[2].mean == Near(0.78014792751087803));
  CHECK(rows[3].within_interval.high - rows[3].mean == Near(0.81109083076963717));
}

TEST_CASE("A larger alpha gives narrower intervals", "[operator][statistics]") {
  const auto table = ReferenceTable("ergoStool");
  const auto narrow = Describe(table, 0.1)[0].mean_interval;
  const auto wide = Describe(table, 0.05)[0].mean_interval;
  CHECK(narrow.low > wide.low);
  CHECK(narrow.high < wide.high);
}

TEST_CASE("Where subjects differ by their level only, the interval within them is a point",
          "[operator][statistics]") {
  const auto rows = Describe(MakeTable({"a", "b"}, {1, 2, 11, 12, 5, 6}), 0.05);
  CHECK(rows[1].within_interval.low == Near(20.0 / 3.0));
  CHECK(rows[1].within_interval.high == Near(20.0 / 3.0));
  CHECK(rows[1].mean_interval.high > 10.0);
}

}  // namespace
}  // namespace conav::statistics
