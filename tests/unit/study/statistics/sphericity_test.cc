#include <catch2/catch.hpp>
#include <cmath>

#include "study/statistics/anova.h"
#include "unit/study/statistics/reference_tables.h"

namespace conav::statistics {
namespace {

TEST_CASE("Mauchly's test and the epsilons are R's", "[operator][statistics]") {
  struct Expected {
    const char* name;
    double w, p, greenhouse_geisser, huynh_feldt;
  };
  for (const Expected& expected :
       {Expected{"ergoStool", 0.17960054668788653, 0.043698867938527251, 0.645921444, 0.848965071},
        Expected{"OBK_pre", 0.11844803792929817, 0.00082006053069892269, 0.522548699, 0.608899906},
        Expected{"obk_phase", 0.70470042951705614, 0.086304164668473612, 0.772022181,
                 0.843667682}}) {
    const auto sphericity = CheckSphericity(ReferenceTable(expected.name));
    INFO(expected.name);
    REQUIRE(sphericity);
    CHECK(*sphericity->mauchly_w == Near(expected.w));
    CHECK(*sphericity->mauchly_p == Near(expected.p));
    CHECK(sphericity->greenhouse_geisser == Near(expected.greenhouse_geisser));
    CHECK(*sphericity->huynh_feldt == Near(expected.huynh_feldt));
    CHECK(*sphericity->huynh_feldt_raw == *sphericity->huynh_feldt);
  }
}

// Six subjects, three conditions; figures of R.
TEST_CASE("An epsilon of Huynh and Feldt above 1 is kept and cut", "[operator][statistics]") {
  const auto sphericity = CheckSphericity(
      MakeTable({"a", "b", "c"}, {8.7, 11.0, 8.8, 10.4, 11.5, 5.6, 8.3, 11.2, 12.2, 13.2, 9.4, 9.9,
                                  10.7, 13.0, 10.0, 8.4, 10.8, 11.9}));
  REQUIRE(sphericity);
  CHECK(sphericity->greenhouse_geisser == Near(0.85791733021078376));
  CHECK(*sphericity->huynh_feldt_raw == Near(1.2628791648465212));
  CHECK(*sphericity->huynh_feldt == 1.0);
  CHECK(*sphericity->mauchly_w == Near(0.83438652561746163));
  CHECK(*sphericity->mauchly_p == Near(0.69620087413197895));
}

TEST_CASE("With two conditions there is nothing to test or to correct", "[operator][statistics]") {
  const auto sphericity = CheckSphericity(SleepTable());
  REQUIRE(sphericity);
  CHECK_FALSE(sphericity->mauchly_w);
  CHECK_FALSE(sphericity->mauchly_p);
  CHECK(sphericity->greenhouse_geisser == 1.0);
  CHECK(*sphericity->huynh_feldt == 1.0);
}

TEST_CASE("Conditions that follow from each other make W 0 and epsilon smallest",
          "[operator][statistics]") {
  // c - a is twice b - a, with any level of a subject.
  const auto sphericity =
      CheckSphericity(MakeTable({"a", "b", "c"}, {1, 2, 3, 5, 9, 13, 2, 2.5, 3, 7, 9.1, 11.2}));
  REQUIRE(sphericity);
  CHECK(*sphericity->mauchly_w == 0.0);
  CHECK(*sphericity->mauchly_p == 0.0);
  CHECK(sphericity->greenhouse_geisser == Near(0.5));
}

TEST_CASE("Fewer subjects than conditions leave Mauchly's test out", "[operator][statistics]") {
  const auto three =
      CheckSphericity(MakeTable({"a", "b", "c", "d"}, {1, 2, 4, 5, 2, 2, 9, 1, 3, 1, 7, 2}));
  REQUIRE(three);
  CHECK_FALSE(three->mauchly_w);
  CHECK(three->greenhouse_geisser >= 1.0 / 3.0);
  const auto two = CheckSphericity(MakeTable({"a", "b", "c"}, {1, 2, 4, 2, 2, 9}));
  REQUIRE(two);
  CHECK(two->greenhouse_geisser == Near(0.5));
  CHECK_FALSE(two->huynh_feldt);
}

TEST_CASE("Constant differences have no sphericity, also where they are rounded",
          "[operator][statistics]") {
  CHECK_FALSE(CheckSphericity(MakeTable({"a", "b", "c"}, {1.1, 2.1, 0.3, 2.1, 3.1, 1.3})));
}

}  // namespace
}  // namespace conav::statistics
