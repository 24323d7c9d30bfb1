#pragma once

#include <optional>
#include <vector>

#include "study/statistics/table_reader.h"

namespace conav::statistics {

/// Whether all differences between conditions vary alike, which the uncorrected F test takes for
/// granted, and by how much its degrees of freedom must shrink where they do not. All of it follows
/// from the covariance S (p x p, p = k - 1) of orthonormal contrasts of the k conditions.
struct Sphericity {
  /// Mauchly, 1940: W = det S / (tr S / p)^p, 0 where S is singular. p is that of
  /// chi squared with the second-order term of Box's series, as in R. Nothing for two conditions,
  /// where there is nothing to test, and for fewer subjects than conditions.
  std::optional<double> mauchly_w;
  std::optional<double> mauchly_p;
  /// Greenhouse and Geisser, 1959: (tr S)^2 / (p tr S^2), in [1 / p, 1].
  double greenhouse_geisser = 1.0;
  /// Huynh and Feldt, 1976, as first printed; may be above 1 (infinite with too few subjects).
  /// Nothing for two subjects and more than two conditions: 0 / 0.
  std::optional<double> huynh_feldt_raw = 1.0;
  /// What degrees of freedom are multiplied by: min(1, raw).
  std::optional<double> huynh_feldt = 1.0;
};

/// Nothing where the conditions differ by the same amounts for every subject: S is zero.
std::optional<Sphericity> CheckSphericity(const ConditionTable& table);

/// One way to take the same F: its degrees of freedom and its p.
struct FTest {
  double df_conditions = 0.0;
  double df_error = 0.0;
  std::optional<double> p;
};

/// Repeated-measures analysis of variance with one factor. With n subjects and k conditions
///   SS_conditions = n sum_j (mean_j - mean)^2,  SS_subjects = k sum_i (mean_i - mean)^2,
///   SS_error = sum_ij (y_ij - mean_i - mean_j + mean)^2,
///   F = [SS_conditions / (k - 1)] / [SS_error / ((k - 1)(n - 1))].
/// No error left over: F is infinite and p 0, or, where the conditions do not differ either, F and
/// p are nothing.
struct Anova {
  double ss_conditions = 0.0;
  double ss_subjects = 0.0;
  double ss_error = 0.0;
  std::optional<double> f;
  FTest uncorrected;
  /// Degrees of freedom times epsilon; nothing where there is no epsilon.
  std::optional<FTest> greenhouse_geisser;
  std::optional<FTest> huynh_feldt;
  /// SS_conditions / (SS_conditions + SS_error); nothing for 0 / 0.
  std::optional<double> partial_eta_squared;
  /// SS_conditions / (all three): Olejnik and Algina, 2003; Bakeman, 2005. Nothing for 0 / 0.
  std::optional<double> generalised_eta_squared;
  std::optional<Sphericity> sphericity;
};

Anova AnalyseVariance(const ConditionTable& table);

/// Friedman, 1937: do the conditions differ, going by each subject's ranking of them only. With the
/// rank sums R_j, n subjects, k conditions, and groups of t equal values within a subject:
///   chi^2 = 12 sum_j (R_j - n (k + 1) / 2)^2 / [n k (k + 1) - sum (t^3 - t) / (k - 1)],
/// compared with chi squared of k - 1 degrees of freedom. Where every subject has equal values
/// throughout, chi^2, p and W are nothing.
struct Friedman {
  std::vector<double> mean_ranks;  // per condition
  double df = 0.0;
  std::optional<double> chi_squared;
  std::optional<double> p;
  std::optional<double> kendall_w;  // chi^2 / [n (k - 1)]: 1 where all rank alike
};

Friedman TestRanks(const ConditionTable& table);

}  // namespace conav::statistics
