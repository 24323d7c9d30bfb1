#include "study/statistics/anova.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "study/statistics/pairs.h"
#include "unit/study/statistics/reference_tables.h"

namespace conav::statistics {
namespace {

TEST_CASE("The analysis of variance is R's", "[operator][statistics]") {
  struct Expected {
    const char* name;
    double df, df_error, f, p, p_gg, p_hf, partial, generalised;
  };
  for (const Expected& expected :
       {Expected{"ergoStool", 3, 24, 22.355640535372874, 3.934563809396555e-07,
                 3.0055638391647314e-05, 2.4830889512105095e-06, 0.736457546, 0.459374509},
        Expected{"OBK_pre", 4, 60, 5.7079646017699011, 0.0005829872388334698, 0.007034005361230054,
                 0.0044531598917430665, 0.275641026, 0.077687444},
        Expected{"obk_phase", 2, 30, 14.852216748768511, 3.2863975037424247e-05,
                 0.00018906408763176718, 0.00010891304282268181, 0.497524752, 0.178191489}}) {
    const Anova anova = AnalyseVariance(ReferenceTable(expected.name));
    INFO(expected.name);
    CHECK(*anova.f == Near(expected.f));
    CHECK(anova.uncorrected.df_conditions == expected.df);
    CHECK(anova.uncorrected.df_error == expected.df_error);
    CHECK(*anova.uncorrected.p == Near(expected.p));
    CHECK(*anova.greenhouse_geisser->p == Near(expected.p_gg));
    CHECK(*anova.huynh_feldt->p == Near(expected.p_hf));
    // The reference has nine digits of these.
    CHECK(std::abs(*anova.partial_eta_squared - expected.partial) <= 5.1e-10);
    CHECK(std::abs(*anova.generalised_eta_squared - expected.generalised) <= 5.1e-10);
    CHECK(anova.greenhouse_geisser->df_error ==
          Near(expected.df_error * anova.sphericity->greenhouse_geisser));
  }
}

TEST_CASE("The sums of squares of ergoStool are R's", "[operator][statistics]") {
  const Anova anova = AnalyseVariance(ReferenceTable("ergoStool"));
  CHECK(anova.ss_subjects == Near(66.5));
  CHECK(anova.ss_conditions == Near(81.194444444444485));
  CHECK(anova.ss_error == Near(29.055555555555536));
}

TEST_CASE("With two conditions F is the square of t", "[operator][statistics]") {
  const ConditionTable sleep = SleepTable();
  const Anova anova = AnalyseVariance(sleep);
  const PairedT t = TestPair(ConditionValues(sleep, 0), ConditionValues(sleep, 1), 0.05);
  CHECK(*anova.f == Near(*t.t * *t.t));
  CHECK(*anova.uncorrected.p == Near(*t.p));
  CHECK(*anova.greenhouse_geisser->p == *anova.uncorrected.p);
}

TEST_CASE("Constant differences make F infinite", "[operator][statistics]") {
  const Anova anova = AnalyseVariance(MakeTable({"a", "b", "c"}, {1.1, 2.1, 0.3, 2.1, 3.1, 1.3}));
  CHECK(anova.ss_error == 0.0);
  CHECK(std::isinf(*anova.f));
  CHECK(*anova.uncorrected.p == 0.0);
  CHECK(*anova.partial_eta_squared == 1.0);
  CHECK_FALSE(anova.greenhouse_geisser);
}

TEST_CASE("Where nothing differs there is no F", "[operator][statistics]") {
  const Anova levels = AnalyseVariance(MakeTable({"a", "b"}, {0.1, 0.1, 0.3, 0.3, 0.7, 0.7}));
  CHECK_FALSE(levels.f);
  CHECK_FALSE(levels.uncorrected.p);
  CHECK_FALSE(levels.partial_eta_squared);
  CHECK(*levels.generalised_eta_squared == 0.0);
  CHECK_FALSE(AnalyseVariance(MakeTable({"a", "b"}, {5, 5, 5, 5})).generalised_eta_squared);
}

TEST_CASE("Neither the unit nor the origin of the values changes F", "[operator][statistics]") {
  const ConditionTable table = ReferenceTable("ergoStool");
  for (const double unit : {1e98, 1e-98}) {
    ConditionTable other = table;
    for (double& value : other.values) value *= unit;
    const Anova anova = AnalyseVariance(other);
    CHECK(*anova.f == Near(*AnalyseVariance(table).f));
    CHECK(*anova.sphericity->mauchly_p == Near(*AnalyseVariance(table).sphericity->mauchly_p));
  }
  ConditionTable other = table;
  for (double& value : other.values) value += 1e6;
  CHECK(*AnalyseVariance(other).f == Near(*AnalyseVariance(table).f));
}

}  // namespace
}  // namespace conav::statistics
