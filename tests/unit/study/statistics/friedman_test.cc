#include <catch2/catch.hpp>

#include "study/statistics/anova.h"
#include "unit/study/statistics/reference_tables.h"

namespace conav::statistics {
namespace {

TEST_CASE("Friedman's test is R's, with ties", "[operator][statistics]") {
  struct Expected {
    const char* name;
    double chi_squared, df, p, w;
  };
  for (const Expected& expected :
       {Expected{"ergoStool", 22.694117647058825, 3, 4.6766964810541517e-05, 0.84052287581699348},
        Expected{"OBK_pre", 17.419354838709676, 4, 0.0016019168122942029, 0.27217741935483869},
        Expected{"obk_phase", 14.771929824561404, 2, 0.00061989223330649005,
                 0.46162280701754388}}) {
    const Friedman test = TestRanks(ReferenceTable(expected.name));
    INFO(expected.name);
    CHECK(*test.chi_squared == Near(expected.chi_squared));
    CHECK(test.df == expected.df);
    CHECK(*test.p == Near(expected.p));
    CHECK(*test.kendall_w == Near(expected.w));
  }
}

TEST_CASE("Who all rank alike agree fully", "[operator][statistics]") {
  const Friedman test = TestRanks(MakeTable({"a", "b", "c"}, {1, 2, 3, 4, 7, 9, 0, 1, 5}));
  CHECK(test.mean_ranks == std::vector<double>{1, 2, 3});
  CHECK(*test.chi_squared == Near(6.0));  // n (k - 1)
  CHECK(*test.kendall_w == Near(1.0));
}

TEST_CASE("Ties everywhere leave no test", "[operator][statistics]") {
  const Friedman test = TestRanks(MakeTable({"a", "b", "c"}, {1, 1, 1, 4, 4, 4}));
  CHECK(test.mean_ranks == std::vector<double>{2, 2, 2});
  CHECK_FALSE(test.chi_squared);
  CHECK_FALSE(test.p);
  CHECK_FALSE(test.kendall_w);
}

}  // namespace
}  // namespace conav::statistics
