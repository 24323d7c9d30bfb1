#include <catch2/catch.hpp>
#include <cmath>

#include "study/statistics/analysis.h"
#include "unit/study/statistics/reference_tables.h"

namespace conav::statistics {
namespace {

TEST_CASE("ANOVA, Mauchly's test, the epsilons and Friedman's test are R's", "[statistics]") {
  struct Expected {
    const char* name;
    double df, df_error, f, p, p_gg, p_hf, partial, generalised;
    double w, w_p, greenhouse_geisser, huynh_feldt;
    double chi_squared, rank_df, rank_p, kendall_w;
  };
  for (const Expected& r :
       {Expected{"ergoStool", 3, 24, 22.355640535372874, 3.934563809396555e-07,
                 3.0055638391647314e-05, 2.4830889512105095e-06, 0.736457546, 0.459374509,
                 0.17960054668788653, 0.043698867938527251, 0.645921444, 0.848965071,
                 22.694117647058825, 3, 4.6766964810541517e-05, 0.84052287581699348},
        Expected{"OBK_pre", 4, 60, 5.7079646017699011, 0.0005829872388334698, 0.007034005361230054,
                 0.0044531598917430665, 0.275641026, 0.077687444, 0.11844803792929817,
                 0.00082006053069892269, 0.522548699, 0.608899906, 17.419354838709676, 4,
                 0.0016019168122942029, 0.27217741935483869},
        Expected{"obk_phase", 2, 30, 14.852216748768511, 3.2863975037424247e-05,
                 0.00018906408763176718, 0.00010891304282268181, 0.497524752, 0.178191489,
                 0.70470042951705614, 0.086304164668473612, 0.772022181, 0.843667682,
                 14.771929824561404, 2, 0.00061989223330649005, 0.46162280701754388}}) {
    INFO(r.name);
    const Anova anova = AnalyseVariance(ReferenceTable(r.name));
    CHECK(*anova.f == Near(r.f));
    CHECK(anova.uncorrected.df_conditions == r.df);
    CHECK(anova.uncorrected.df_error == r.df_error);
    CHECK(*anova.uncorrected.p == Near(r.p));
    CHECK(*anova.greenhouse_geisser->p == Near(r.p_gg));
    CHECK(*anova.huynh_feldt->p == Near(r.p_hf));
    // The reference has nine digits of these.
    CHECK(std::abs(*anova.partial_eta_squared - r.partial) <= 5.1e-10);
    CHECK(std::abs(*anova.generalised_eta_squared - r.generalised) <= 5.1e-10);
    REQUIRE(anova.sphericity);
    CHECK(anova.greenhouse_geisser->df_error ==
          Near(r.df_error * anova.sphericity->greenhouse_geisser));
    CHECK(*anova.sphericity->mauchly_w == Near(r.w));
    CHECK(*anova.sphericity->mauchly_p == Near(r.w_p));
    CHECK(anova.sphericity->greenhouse_geisser == Near(r.greenhouse_geisser));
    CHECK(*anova.sphericity->huynh_feldt == Near(r.huynh_feldt));
    CHECK(*anova.sphericity->huynh_feldt_raw == *anova.sphericity->huynh_feldt);
    const Friedman ranks = TestRanks(ReferenceTable(r.name));
    CHECK(*ranks.chi_squared == Near(r.chi_squared));
    CHECK(ranks.df == r.rank_df);
    CHECK(*ranks.p == Near(r.rank_p));
    CHECK(*ranks.kendall_w == Near(r.kendall_w));
  }
}

TEST_CASE("With two conditions F is the square of t and sphericity always holds", "[statistics]") {
  const ConditionTable sleep = SleepTable();
  const Anova anova = AnalyseVariance(sleep);
  const PairedT t = TestPair(ConditionValues(sleep, 0), ConditionValues(sleep, 1), 0.05);
  CHECK(*anova.f == Near(*t.t * *t.t));
  CHECK(*anova.uncorrected.p == Near(*t.p));
  CHECK(*anova.greenhouse_geisser->p == *anova.uncorrected.p);
  REQUIRE(anova.sphericity);
  CHECK_FALSE(anova.sphericity->mauchly_w);
  CHECK_FALSE(anova.sphericity->mauchly_p);
  CHECK(anova.sphericity->greenhouse_geisser == 1.0);
  CHECK(*anova.sphericity->huynh_feldt == 1.0);
}

TEST_CASE("Constant differences make F infinite, also where rounded, where nothing differs is no F",
          "[statistics]") {
  const Anova anova = AnalyseVariance(MakeTable({"a", "b", "c"}, {1.1, 2.1, 0.3, 2.1, 3.1, 1.3}));
  CHECK(anova.ss_error == 0.0);
  CHECK(std::isinf(*anova.f));
  CHECK(*anova.uncorrected.p == 0.0);
  CHECK(*anova.partial_eta_squared == 1.0);
  CHECK_FALSE(anova.greenhouse_geisser);
  CHECK_FALSE(anova.sphericity);
  const Anova levels = AnalyseVariance(MakeTable({"a", "b"}, {0.1, 0.1, 0.3, 0.3, 0.7, 0.7}));
  CHECK_FALSE(levels.f);
  CHECK_FALSE(levels.uncorrected.p);
  CHECK_FALSE(levels.partial_eta_squared);
  CHECK(*levels.generalised_eta_squared == 0.0);
  CHECK_FALSE(AnalyseVariance(MakeTable({"a", "b"}, {5, 5, 5, 5})).generalised_eta_squared);
}

TEST_CASE("Neither the unit nor the origin of the values changes F", "[statistics]") {
  const ConditionTable table = ReferenceTable("ergoStool");
  for (const auto& [unit, origin] :
       std::vector<std::pair<double, double>>{{1e98, 0.0}, {1e-98, 0.0}, {1.0, 1e6}}) {
    ConditionTable other = table;
    for (double& value : other.values) value = value * unit + origin;
    const Anova anova = AnalyseVariance(other);
    CHECK(*anova.f == Near(*AnalyseVariance(table).f));
    if (origin != 0.0) continue;
    CHECK(*anova.sphericity->mauchly_p == Near(*AnalyseVariance(table).sphericity->mauchly_p));
  }
}

// Six subjects, three conditions; figures of R.
TEST_CASE("An epsilon of Huynh and Feldt above 1 is kept and cut", "[statistics]") {
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

TEST_CASE("Conditions that follow from each other make W 0 and epsilon smallest", "[statistics]") {
  // c - a is twice b - a, with any level of a subject.
  const auto sphericity =
      CheckSphericity(MakeTable({"a", "b", "c"}, {1, 2, 3, 5, 9, 13, 2, 2.5, 3, 7, 9.1, 11.2}));
  REQUIRE(sphericity);
  CHECK(*sphericity->mauchly_w == 0.0);
  CHECK(*sphericity->mauchly_p == 0.0);
  CHECK(sphericity->greenhouse_geisser == Near(0.5));
}

TEST_CASE("Fewer subjects than conditions leave Mauchly's test out", "[statistics]") {
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

TEST_CASE("Subjects that all rank alike agree fully, ties everywhere leave no test",
          "[statistics]") {
  const Friedman agree = TestRanks(MakeTable({"a", "b", "c"}, {1, 2, 3, 4, 7, 9, 0, 1, 5}));
  CHECK(agree.mean_ranks == std::vector<double>{1, 2, 3});
  CHECK(*agree.chi_squared == Near(6.0));  // n (k - 1)
  CHECK(*agree.kendall_w == Near(1.0));
  const Friedman ties = TestRanks(MakeTable({"a", "b", "c"}, {1, 1, 1, 4, 4, 4}));
  CHECK(ties.mean_ranks == std::vector<double>{2, 2, 2});
  CHECK_FALSE(ties.chi_squared);
  CHECK_FALSE(ties.p);
  CHECK_FALSE(ties.kendall_w);
}

}  // namespace
}  // namespace conav::statistics
