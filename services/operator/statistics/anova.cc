#include "operator/statistics/anova.h"

#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "operator/statistics/distributions.h"
#include "operator/statistics/moments.h"

namespace conav::statistics {
namespace {

/// `sum` of `count` squares, 0 where they are nothing but rounding errors.
double Exact(double sum, std::size_t count, double magnitude) {
  const double error = RoundingError(magnitude);
  return sum <= static_cast<double>(count) * error * error ? 0.0 : sum;
}

void SetSums(Anova& anova, const ConditionTable& table) {
  const std::size_t n = table.subject_count();
  const std::size_t k = table.condition_count();
  std::vector<double> subject_means;
  for (std::size_t i = 0; i < n; ++i) {
    subject_means.push_back(Mean(std::span(table.values).subspan(i * k, k)));
  }
  std::vector<double> condition_means;
  for (std::size_t j = 0; j < k; ++j) condition_means.push_back(Mean(ConditionValues(table, j)));
  const double mean = Mean(condition_means);
  double error = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < k; ++j) {
      error += std::pow(table.At(i, j) - subject_means[i] - condition_means[j] + mean, 2);
    }
  }
  const double magnitude = Magnitude(table);
  anova.ss_conditions =
      Exact(static_cast<double>(n) * SquaredDeviations(condition_means), n * k, magnitude);
  anova.ss_subjects =
      Exact(static_cast<double>(k) * SquaredDeviations(subject_means), n * k, magnitude);
  anova.ss_error = Exact(error, n * k, magnitude);
}

std::optional<double> Share(double part, double rest) {
  if (part + rest <= 0.0) return std::nullopt;
  return part / (part + rest);
}

std::optional<double> FRatio(const Anova& anova) {
  if (anova.ss_error > 0.0) {
    return anova.ss_conditions / anova.uncorrected.df_conditions /
           (anova.ss_error / anova.uncorrected.df_error);
  }
  if (anova.ss_conditions <= 0.0) return std::nullopt;
  return std::numeric_limits<double>::infinity();
}

FTest Corrected(const Anova& anova, double epsilon) {
  FTest test{epsilon * anova.uncorrected.df_conditions, epsilon * anova.uncorrected.df_error, {}};
  if (anova.f) test.p = FisherUpper(*anova.f, test.df_conditions, test.df_error);
  return test;
}

}  // namespace

Anova AnalyseVariance(const ConditionTable& table) {
  Anova anova;
  SetSums(anova, table);
  const auto df = static_cast<double>(table.condition_count() - 1);
  anova.uncorrected = {df, df * static_cast<double>(table.subject_count() - 1), {}};
  anova.f = FRatio(anova);
  anova.uncorrected = Corrected(anova, 1.0);
  anova.partial_eta_squared = Share(anova.ss_conditions, anova.ss_error);
  anova.generalised_eta_squared = Share(anova.ss_conditions, anova.ss_subjects + anova.ss_error);
  if (anova.ss_error > 0.0) anova.sphericity = CheckSphericity(table);
  if (anova.sphericity) {
    anova.greenhouse_geisser = Corrected(anova, anova.sphericity->greenhouse_geisser);
    if (anova.sphericity->huynh_feldt) {
      anova.huynh_feldt = Corrected(anova, *anova.sphericity->huynh_feldt);
    }
  }
  return anova;
}

}  // namespace conav::statistics
