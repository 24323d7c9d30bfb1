#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "common/runtime/random.h"
#include "study/statistics/analysis.h"

namespace conav::statistics {
namespace {

TEST_CASE("The power of a paired t test is that of noncentral t", "[statistics][power]") {
  // Computed by numerical integration over the standard deviation; G*Power 3.1 prints the same four
  // digits for the first three.
  const struct {
    double d_z;
    int subjects;
    double power;
  } rows[] = {{0.5, 34, 0.8077775012792514},
              {0.8, 15, 0.8213105387240697},
              {0.2, 199, 0.8016910240370139},
              {-0.5, 33, 0.7953658414874762},
              {1.2, 5, 0.5302212511402403}};
  for (const auto& row : rows) {
    CHECK(PairedTPower(row.d_z, row.subjects, 0.05) == Approx(row.power).epsilon(1e-6));
  }
  CHECK(PairedTPower(0.0, 20, 0.05) == Approx(0.05));
  CHECK(PairedTPower(HUGE_VAL, 2, 0.05) == 1.0);
}

TEST_CASE("The fewest subjects are found wherever they are", "[statistics][power]") {
  for (const int limit : {1, 2, 3, 34, 64, 65, 999, 1000}) {
    CHECK(FewestSubjects([&](int subjects) { return subjects >= limit; }) == std::max(2, limit));
  }
  CHECK_FALSE(FewestSubjects([](int) { return false; }));
}

/// A pilot whose pair (a, b) has exactly this d_z, and c is a with other noise.
ConditionTable Pilot(double d_z, int subjects, bool with_third) {
  Random random(3);
  std::vector<double> noise;
  for (int i = 0; i < subjects; ++i) noise.push_back(DrawNormal(random));
  const double mean = Mean(noise);
  const double sd = StandardDeviation(noise);
  ConditionTable table{.conditions = {"a", "b"}};
  if (with_third) table.conditions.push_back("c");
  for (int i = 0; i < subjects; ++i) {
    const double level = 10.0 + 3.0 * DrawNormal(random);
    table.subjects.push_back(std::to_string(i));
    table.values.push_back(level + d_z + (noise[static_cast<std::size_t>(i)] - mean) / sd);
    table.values.push_back(level);
    if (with_third) table.values.push_back(level + 0.5 * DrawNormal(random));
  }
  return table;
}

TEST_CASE("With one pair the simulation agrees with the formula", "[statistics][power]") {
  for (const double d_z : {0.5, 0.8, 1.5}) {
    const SamplePlan plan = PlanSubjects(Pilot(d_z, 12, false), 0.05);
    const PairPlan& pair = plan.pairs.at(0);
    CHECK(*pair.d_z == Approx(d_z));
    const int exact = *pair.alone.for_power;
    const int margin = 1 + exact / 12;  // 2,000 draws: 0.8 -+ 0.018
    CHECK(std::abs(*pair.holm.for_power - exact) <= margin);
    CHECK(std::abs(*pair.holm.for_high_power - *pair.alone.for_high_power) <= margin + 1);
    // F of two conditions is t squared.
    CHECK(*plan.anova.for_power == *pair.holm.for_power);
    CHECK(*plan.anova_resampled.for_power == *pair.holm_resampled.for_power);
  }
  CHECK(PlanSubjects(Pilot(0.5, 12, false), 0.05).pairs[0].alone.for_power == 34);
}

TEST_CASE("Holm's correction costs subjects, and so does caution", "[statistics][power]") {
  const ConditionTable pilot = Pilot(0.9, 10, true);
  const SamplePlan plan = PlanSubjects(pilot, 0.05);
  REQUIRE(plan.pairs.size() == 3);
  CHECK(plan.pilot_subjects == 10);
  const PairPlan& pair = plan.pairs[0];
  CHECK(*pair.holm.for_power >= *pair.alone.for_power);
  CHECK(*pair.holm.for_high_power > *pair.holm.for_power);
  CHECK(*pair.cautious_d_z < 0.9);
  CHECK(*pair.cautious.for_power > *pair.alone.for_power);
  // The same values give the same plan.
  const SamplePlan again = PlanSubjects(pilot, 0.05);
  CHECK(again.pairs[0].holm.for_power == pair.holm.for_power);
  CHECK(again.anova.for_high_power == plan.anova.for_high_power);
}

TEST_CASE("A difference without spread needs two subjects, none needs too many",
          "[statistics][power]") {
  ConditionTable pilot{.conditions = {"a", "b"}, .subjects = {"p", "q"}, .values = {2, 1, 5, 4}};
  SamplePlan plan = PlanSubjects(pilot, 0.05);
  CHECK(plan.pairs[0].alone.for_power == 2);
  CHECK(plan.pairs[0].holm.for_power == 2);
  pilot.values = {1, 2, 2, 1};
  plan = PlanSubjects(pilot, 0.05);
  CHECK_FALSE(plan.pairs[0].alone.for_power);
  CHECK_FALSE(plan.pairs[0].holm.for_power);
  CHECK_FALSE(plan.pairs[0].cautious_d_z);
}

}  // namespace
}  // namespace conav::statistics
