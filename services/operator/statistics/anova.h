#pragma once

#include <optional>

#include "operator/statistics/condition_table.h"
#include "operator/statistics/sphericity.h"

namespace conav::statistics {

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

}  // namespace conav::statistics
