#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "study/statistics/moments.h"
#include "study/statistics/table_reader.h"

namespace conav::statistics {

/// Tests whether all differences between conditions have the same variance, as the uncorrected F
/// test assumes, and estimates by how much its degrees of freedom must shrink if not. Everything
/// follows from the covariance S (p x p, p = k - 1) of orthonormal contrasts of the k conditions.
struct Sphericity {
  /// Mauchly, 1940: W = det S / (tr S / p)^p, 0 if S is singular. p is that of
  /// chi squared with the second-order term of Box's series, as in R. Empty for two conditions,
  /// which need no test, and for fewer subjects than conditions.
  std::optional<double> mauchly_w;
  std::optional<double> mauchly_p;
  /// Greenhouse and Geisser, 1959: (tr S)^2 / (p tr S^2), in [1 / p, 1].
  double greenhouse_geisser = 1.0;
  /// Huynh and Feldt, 1976, as first printed; may be above 1 (infinite for too few subjects). Empty
  /// for two subjects and more than two conditions: 0 / 0.
  std::optional<double> huynh_feldt_raw = 1.0;
  /// The factor for degrees of freedom: min(1, raw).
  std::optional<double> huynh_feldt = 1.0;
};

/// Empty if the conditions differ by the same amounts for every subject: S is zero.
std::optional<Sphericity> CheckSphericity(const ConditionTable& table);

/// One evaluation of F: its degrees of freedom and its p.
struct FTest {
  double df_conditions = 0.0;
  double df_error = 0.0;
  std::optional<double> p;
};

/// Repeated-measures analysis of variance with one factor. With n subjects and k conditions
///   SS_conditions = n sum_j (mean_j - mean)^2,  SS_subjects = k sum_i (mean_i - mean)^2,
///   SS_error = sum_ij (y_ij - mean_i - mean_j + mean)^2,
///   F = [SS_conditions / (k - 1)] / [SS_error / ((k - 1)(n - 1))].
/// If the error is 0, F is infinite and p is 0; if the conditions do not differ either, F and p are
/// empty.
struct Anova {
  double ss_conditions = 0.0;
  double ss_subjects = 0.0;
  double ss_error = 0.0;
  std::optional<double> f;
  FTest uncorrected;
  /// Degrees of freedom times epsilon; empty without epsilon.
  std::optional<FTest> greenhouse_geisser;
  std::optional<FTest> huynh_feldt;
  /// SS_conditions / (SS_conditions + SS_error); empty for 0 / 0.
  std::optional<double> partial_eta_squared;
  /// SS_conditions / (all three): Olejnik and Algina, 2003; Bakeman, 2005. Empty for 0 / 0.
  std::optional<double> generalised_eta_squared;
  std::optional<Sphericity> sphericity;
};

Anova AnalyseVariance(const ConditionTable& table);

/// Friedman, 1937: tests whether the conditions differ, using only each subject's ranking of them.
/// With the rank sums R_j, n subjects, k conditions, and groups of t equal values within a subject:
///   chi^2 = 12 sum_j (R_j - n (k + 1) / 2)^2 / [n k (k + 1) - sum (t^3 - t) / (k - 1)], compared
///   with chi squared of k - 1 degrees of freedom. If all values of every subject are equal, chi^2,
///   p and W are empty.
struct Friedman {
  std::vector<double> mean_ranks;  // per condition
  double df = 0.0;
  std::optional<double> chi_squared;
  std::optional<double> p;
  std::optional<double> kendall_w;  // chi^2 / [n (k - 1)]: 1 if all rankings agree
};

Friedman TestRanks(const ConditionTable& table);

inline constexpr std::size_t kMostShapiroValues = 5000;  // the limit of the algorithm's fit

/// Tests for a normal distribution; W is near 1 for one.
struct ShapiroWilk {
  double w = 0.0;
  double p = 0.0;
};

/// Royston, "Remark AS R94: a remark on algorithm AS 181", Applied Statistics 44, 1995: the weights
/// of the ordered values and the normalising transformation of 1 - W are polynomials in the sample
/// size. Empty for fewer than 3 values, for more than kMostShapiroValues, and for equal ones.
/// `error` bounds the rounding error of a value.
std::optional<ShapiroWilk> TestNormality(std::span<const double> values, double error);

/// Student's t test of two conditions of the same subjects, on the differences first - second. If
/// all differences are equal and not 0, t, d_z and g_z are infinite, p is 0 and the interval is a
/// point; if all are 0, these four are empty.
struct PairedT {
  double mean_difference = 0.0;
  Interval interval;  // of the mean difference
  double df = 0.0;    // n - 1
  std::optional<double> t;
  std::optional<double> p;  // two-sided
  /// Mean over standard deviation of the differences: t = d_z sqrt(n). Cohen, 1988.
  std::optional<double> d_z;
  /// Mean difference over sqrt((s1^2 + s2^2) / 2): in units of the spread between subjects.
  /// Infinite or empty if neither condition varies.
  std::optional<double> d_av;
  /// d_z times Hedges' correction for few subjects, 1 - 3 / (4 df - 1); empty for two subjects.
  std::optional<double> g_z;
};

/// Two values per subject, at least two subjects, in the same order.
PairedT TestPair(std::span<const double> first, std::span<const double> second, double alpha);

/// Wilcoxon's signed rank test, 1945, of first - second. Differences of 0 are left out; V is the
/// sum of the ranks of |difference| over the positive ones. p is two-sided: exact without ties,
/// without zeros and for fewer than 50 differences, else from the normal distribution with the
/// variance corrected for ties and V moved by 1/2 towards its mean. Empty if all differences are 0.
/// Differences that only rounding makes unequal (1.3 - 1.1 and 0.4 - 0.2) are ties.
struct Wilcoxon {
  std::size_t used = 0;  // differences other than 0
  bool exact = false;
  std::optional<double> v;
  std::optional<double> p;
};

/// Two values per subject in the same order.
Wilcoxon TestSignedRanks(std::span<const double> first, std::span<const double> second);

/// The margin of "comparable" in the studies: 5 % of the baseline.
inline constexpr double kEquivalenceMargin = 0.05;

/// Two one-sided tests (Schuirmann, 1987) of whether the ratio of two means lies within 1 -+ margin,
/// on paired values x (first) and y (second, the baseline). The hypotheses of a ratio are linear, so
/// each test is Student's paired t, exact for normal values, with the baseline's mean estimated:
///   x - (1 - margin) y > 0 and (1 + margin) y - x > 0;  p is the larger one-sided p.
/// The interval is Fieller's of the ratio, with probability 1 - 2 alpha: equivalent (p < alpha) where
/// it lies within 1 -+ margin. Empty: the baseline's mean is not above 0 beyond doubt.
struct Equivalence {
  double margin = kEquivalenceMargin;
  double ratio = 1.0;
  std::optional<Interval> interval;
  double p = 1.0;
  bool is_shown = false;  // p < alpha
  /// Number of subjects for a power of kPower, if it was asked for: SubjectsForEquivalence().
  std::optional<int> subjects;
};

/// Values of the same subjects in the same order, at least two.
Equivalence TestEquivalence(std::span<const double> first, std::span<const double> second,
                            double margin, double alpha);

inline constexpr double kPower = 0.8;
inline constexpr int kMostSubjectsForPower = 1000;

/// How many subjects TestEquivalence needs to show with probability kPower that conditions with equal
/// means are equivalent: simulates normal values with the variances and covariance observed, both
/// means those of `second`. Empty for more than kMostSubjectsForPower. The same values give the same
/// number.
std::optional<int> SubjectsForEquivalence(std::span<const double> first,
                                          std::span<const double> second, double margin,
                                          double alpha);

/// The fewest subjects, 2 to kMostSubjectsForPower, for which `is_enough` holds, which more subjects never
/// make false. Empty: those are not enough.
std::optional<int> FewestSubjects(const std::function<bool(int subjects)>& is_enough);

/// Power of the two-sided paired t test: P(|T| > t(n - 1, 1 - alpha / 2)) of noncentral t with
/// noncentrality d_z sqrt(n).
double PairedTPower(double d_z, int subjects, double alpha);

inline constexpr double kHighPower = 0.9;

/// Empty: more than kMostSubjectsForPower.
struct SubjectsNeeded {
  std::optional<int> for_power;       // kPower
  std::optional<int> for_high_power;  // kHighPower
};

/// How many subjects show one pair of conditions, if people differ as those of a pilot do.
struct PairPlan {
  std::string first;
  std::string second;
  std::optional<double> d_z;  // of the pilot
  SubjectsNeeded alone;       // as the only test: PairedTPower
  SubjectsNeeded holm;        // adjusted for all pairs; subjects drawn from a normal distribution
  SubjectsNeeded holm_resampled;  // the same, drawn from the subjects of the pilot
  /// The lower end of the 60 % interval of |d_z| (Perugini, Gallucci and Costantini, 2014), and the subjects
  /// for it with alpha / number of pairs. Empty: not above 0.
  std::optional<double> cautious_d_z;
  SubjectsNeeded cautious;
};

struct SamplePlan {
  std::size_t pilot_subjects = 0;
  std::vector<PairPlan> pairs;  // in ComparePairs' order
  SubjectsNeeded anova;         // Greenhouse and Geisser's p below alpha
  SubjectsNeeded anova_resampled;
};

/// Simulates 2,000 studies for each number of subjects it tries, with the pilot's means and covariance. The
/// same values give the same numbers.
SamplePlan PlanSubjects(const ConditionTable& pilot, double alpha);

/// A p adjusted for the number of tests; at most 1. Empty for a test without p.
struct AdjustedP {
  std::optional<double>
      holm;  // Holm, 1979: times m, m - 1, ... from the smallest on, never falling
  std::optional<double> bonferroni;  // m p
  std::optional<double> bh;          // Benjamini and Hochberg, 1995: false discovery rate
};

/// In the order of `p`. m excludes tests without p.
std::vector<AdjustedP> AdjustForMany(const std::vector<std::optional<double>>& p);

/// All results for two conditions, from their differences first - second. Each test's p is adjusted
/// for the number of pairs.
struct Pair {
  std::string first;
  std::string second;
  PairedT t;
  AdjustedP t_adjusted;
  Wilcoxon wilcoxon;
  AdjustedP wilcoxon_adjusted;
  // of the differences, which the t test assumes to be normal
  std::optional<ShapiroWilk> normality;
  std::optional<Equivalence> equivalence;  // if AddEquivalence() was called for it
};

/// Every condition with every later one, in the table's order.
std::vector<Pair> ComparePairs(const ConditionTable& table, double alpha);

/// One condition by itself.
struct Description {
  std::string condition;
  std::size_t n = 0;
  double mean = 0.0;
  double standard_deviation = 0.0;
  double median = 0.0;
  /// Confidence interval of the mean over such people: Student's t, n - 1 degrees of freedom.
  Interval mean_interval;
  /// For comparing conditions: the same after removing each subject's own level (Cousineau,
  /// "Confidence intervals in within-subject designs", 2005), with the standard error times sqrt(k
  /// / (k - 1)) for k conditions (Morey, 2008).
  Interval within_interval;
};

/// A row per condition; intervals hold with probability 1 - alpha.
std::vector<Description> Describe(const ConditionTable& table, double alpha);

/// All results for one table.
struct Analysis {
  std::string file;    // its name, without folder
  std::string sha256;  // of its bytes
  double alpha = 0.05;
  ConditionTable table;
  std::vector<LeftOut> left_out;
  std::vector<Description> conditions;
  Anova anova;
  std::vector<Pair> pairs;
  Friedman friedman;
  /// Remarks for the reader: which subjects were left out, which figures are missing and why. One
  /// sentence each.
  std::vector<std::string> notes;
};

/// Confidence intervals hold with probability 1 - alpha; alpha in (0, 1).
Analysis Analyse(TableFile file, double alpha);

/// The same of a table's text, with the name and SHA-256 of its file. Errors: as ParseTable.
[[nodiscard]] Result<Analysis> AnalyseText(std::string_view text, const std::string& name,
                                           double alpha);

/// Tests the pairs whose first condition is `only` (empty = all pairs) for equivalence; with
/// `with_power` simulates the number of subjects, too.
void AddEquivalence(Analysis& analysis, double margin, bool with_power,
                    const std::string& only = "");

}  // namespace conav::statistics
