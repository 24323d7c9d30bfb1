#include "study/statistics/analysis.h"

#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <span>
#include <utility>

#include "common/runtime/text.h"

namespace conav::statistics {
namespace {

/// Helmert's orthonormal contrasts: contrast c of a subject is condition c + 1 against the mean of
/// those before it, [subjects, contrasts].
Eigen::MatrixXd Contrasts(const ConditionTable& table) {
  Eigen::MatrixXd contrasts(table.subject_count(), table.condition_count() - 1);
  for (std::size_t i = 0; i < table.subject_count(); ++i) {
    double sum = 0.0;
    for (std::size_t c = 0; c + 1 < table.condition_count(); ++c) {
      sum += table.At(i, c);
      const auto before = static_cast<double>(c + 1);
      contrasts(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(c)) =
          (table.At(i, c + 1) - sum / before) * std::sqrt(before / (before + 1.0));
    }
  }
  return contrasts;
}

/// Of the columns.
Eigen::MatrixXd Covariance(const Eigen::MatrixXd& columns) {
  const Eigen::MatrixXd centred = columns.rowwise() - columns.colwise().mean();
  return centred.transpose() * centred / static_cast<double>(columns.rows() - 1);
}

/// Of a covariance with trace 1; minus infinity if it is singular. `error` bounds the rounding errors
/// of its values.
double LogDeterminant(const Eigen::MatrixXd& covariance, double error) {
  const double smallest =
      std::max(static_cast<double>(covariance.rows()) * RoundingError(1.0), error);
  const Eigen::LLT<Eigen::MatrixXd> cholesky(covariance);
  const Eigen::ArrayXd pivots = cholesky.matrixLLT().diagonal().array().square();
  if (cholesky.info() != Eigen::Success || pivots.minCoeff() <= smallest) {
    return -std::numeric_limits<double>::infinity();
  }
  return pivots.log().sum();
}

/// P(W <= w) under sphericity, `df` = n - 1: Anderson, "An introduction to multivariate statistical
/// analysis", section 10.7, two terms of Box's series, which can end above 1 for few subjects.
/// The series has 3 p in the second term; R's mauchly.test has 3 (p + 1) there. We follow R, because
/// people compare with it: p moves by less than 0.005.
double MauchlyP(double log_w, double p, double df) {
  const double rho = 1.0 - (2.0 * p * p + p + 2.0) / (6.0 * p * df);
  const double omega = (p + 2.0) * (p - 1.0) * (p - 2.0) *
                       (2.0 * p * p * p + 6.0 * p * p + 3.0 * (p + 1.0) + 2.0) /
                       (288.0 * std::pow(p * df * rho, 2));
  const double chi_squared = std::max(0.0, -df * rho * log_w);
  const double chi_df = p * (p + 1.0) / 2.0 - 1.0;
  const double first = ChiSquaredUpper(chi_squared, chi_df);
  const double second = ChiSquaredUpper(chi_squared, chi_df + 4.0);
  return std::min(1.0, first + omega * (second - first));
}

/// For n - 1 = `df`; empty for 0 / 0.
std::optional<double> HuynhFeldt(double epsilon, double p, double df) {
  const double above = (df + 1.0) * p * epsilon - 2.0;
  const double below = p * (df - p * epsilon);
  if (below > RoundingError(p * df)) return above / below;
  if (above <= RoundingError(p * df)) return std::nullopt;
  return std::numeric_limits<double>::infinity();
}

/// `sum` of `count` squares, or 0 if they are nothing but rounding errors.
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

std::optional<Sphericity> CheckSphericity(const ConditionTable& table) {
  Eigen::MatrixXd covariance = Covariance(Contrasts(table));
  const double trace = covariance.trace();
  const double error = RoundingError(Magnitude(table));
  if (std::sqrt(trace) <= error) return std::nullopt;
  Sphericity result;
  if (table.condition_count() == 2) return result;
  covariance /= trace;  // removes the unit and prevents overflow of large values
  const auto p = static_cast<double>(covariance.rows());
  const auto df = static_cast<double>(table.subject_count() - 1);
  result.greenhouse_geisser = std::clamp(1.0 / (p * covariance.squaredNorm()), 1.0 / p, 1.0);
  result.huynh_feldt_raw = HuynhFeldt(result.greenhouse_geisser, p, df);
  result.huynh_feldt = result.huynh_feldt_raw;
  if (result.huynh_feldt) result.huynh_feldt = std::min(1.0, *result.huynh_feldt);
  if (df >= p) {
    const double log_determinant = LogDeterminant(covariance, error * error / trace);
    const double log_w = std::min(0.0, log_determinant + p * std::log(p));
    result.mauchly_w = std::exp(log_w);
    result.mauchly_p = MauchlyP(log_w, p, df);
  }
  return result;
}

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

Friedman TestRanks(const ConditionTable& table) {
  const std::size_t k_count = table.condition_count();
  const auto n = static_cast<double>(table.subject_count());
  const auto k = static_cast<double>(k_count);
  std::vector<double> rank_sums(k_count);
  double tie_sum = 0.0;
  for (std::size_t i = 0; i < table.subject_count(); ++i) {
    const auto row = std::span(table.values).subspan(i * k_count, k_count);
    const Ranks ranks = RankValues(row, RoundingError(Magnitude(row)));
    for (std::size_t j = 0; j < k_count; ++j) rank_sums[j] += ranks.ranks[j];
    tie_sum += ranks.tie_sum;
  }
  Friedman result{.df = k - 1.0};
  for (const double sum : rank_sums) result.mean_ranks.push_back(sum / n);
  const double denominator = n * k * (k + 1.0) - tie_sum / (k - 1.0);
  if (denominator <= 0.0) return result;
  // The rank sums' mean is n (k + 1) / 2.
  result.chi_squared = 12.0 * SquaredDeviations(rank_sums) / denominator;
  result.p = ChiSquaredUpper(*result.chi_squared, result.df);
  result.kendall_w = *result.chi_squared / (n * (k - 1.0));
  return result;
}

namespace {

/// Moves each subject's mean to the mean of all.
ConditionTable WithoutSubjectLevels(const ConditionTable& table) {
  ConditionTable moved = table;
  const double grand_mean = Mean(table.values);
  const std::size_t k = table.condition_count();
  for (std::size_t i = 0; i < table.subject_count(); ++i) {
    const std::span row = std::span(moved.values).subspan(i * k, k);
    const double level = Mean(row);
    for (double& value : row) value += grand_mean - level;
  }
  return moved;
}

using Notes = std::vector<std::string>;

void NoteLeftOut(const Analysis& analysis, Notes& notes) {
  for (const LeftOut& left : analysis.left_out) {
    notes.push_back(fmt::format("Subject {} (line {}) is left out: no value in {}.", left.subject,
                                left.line, Join(left.missing, ", ")));
  }
}

void NoteAnova(const Analysis& analysis, Notes& notes) {
  const Anova& anova = analysis.anova;
  if (!anova.f) {
    notes.push_back("Every subject has the same value in all conditions: there is no F.");
  } else if (std::isinf(*anova.f)) {
    notes.push_back(
        "The conditions differ by the same amounts for every subject: no error is left, F is "
        "infinite.");
  }
  if (!anova.sphericity) return;
  if (analysis.table.condition_count() == 2) {
    notes.push_back("Two conditions: sphericity always holds, nothing is corrected, F is t^2.");
    return;
  }
  if (!anova.sphericity->mauchly_w) {
    notes.push_back("Fewer subjects than conditions: Mauchly's test is not possible.");
  } else if (*anova.sphericity->mauchly_w == 0.0) {
    notes.push_back(
        "Some differences between conditions follow from others for every subject: Mauchly's W is "
        "0.");
  }
  if (!anova.sphericity->huynh_feldt) {
    notes.push_back("Two subjects: there is no Huynh-Feldt epsilon.");
  }
}

void NotePairs(const Analysis& analysis, Notes& notes) {
  for (const Pair& pair : analysis.pairs) {
    if (!pair.t.t) {
      notes.push_back(
          fmt::format("{} and {} are equal for every subject: there is nothing to test.",
                      pair.first, pair.second));
    } else if (std::isinf(*pair.t.t)) {
      notes.push_back(fmt::format(
          "{} and {} differ by the same amount for every subject: t, d_z and g_z are infinite.",
          pair.first, pair.second));
    }
  }
}

void NoteSubjectCount(const Analysis& analysis, Notes& notes) {
  if (analysis.table.subject_count() == 2) {
    notes.push_back("Two subjects: there is neither g_z nor a Shapiro-Wilk test.");
  }
  if (analysis.table.subject_count() > kMostShapiroValues) {
    notes.push_back(
        fmt::format("More than {} subjects: there is no Shapiro-Wilk test.", kMostShapiroValues));
  }
}

void NoteRanks(const Analysis& analysis, Notes& notes) {
  if (!analysis.friedman.chi_squared) {
    notes.push_back("Within every subject all values are equal: there is no Friedman test.");
  }
}

}  // namespace

std::vector<Description> Describe(const ConditionTable& table, double alpha) {
  const ConditionTable moved = WithoutSubjectLevels(table);
  const auto n = static_cast<double>(table.subject_count());
  const auto k = static_cast<double>(table.condition_count());
  std::vector<Description> rows;
  for (std::size_t j = 0; j < table.condition_count(); ++j) {
    const std::vector<double> values = ConditionValues(table, j);
    const double mean = Mean(values);
    const double deviation = StandardDeviation(values);
    const double within = StandardDeviation(ConditionValues(moved, j)) * std::sqrt(k / (k - 1.0));
    rows.push_back({.condition = table.conditions[j],
                    .n = table.subject_count(),
                    .mean = mean,
                    .standard_deviation = deviation,
                    .median = Median(values),
                    .mean_interval = StudentInterval(mean, deviation / std::sqrt(n), n - 1, alpha),
                    .within_interval = StudentInterval(mean, within / std::sqrt(n), n - 1, alpha)});
  }
  return rows;
}

Analysis Analyse(TableFile file, double alpha) {
  Analysis analysis;
  analysis.alpha = alpha;
  analysis.conditions = Describe(file.table, alpha);
  analysis.anova = AnalyseVariance(file.table);
  analysis.pairs = ComparePairs(file.table, alpha);
  analysis.friedman = TestRanks(file.table);
  analysis.table = std::move(file.table);
  analysis.left_out = std::move(file.left_out);
  Notes notes;
  NoteLeftOut(analysis, notes);
  NoteSubjectCount(analysis, notes);
  NoteAnova(analysis, notes);
  NotePairs(analysis, notes);
  NoteRanks(analysis, notes);
  analysis.notes = std::move(notes);
  return analysis;
}

Result<Analysis> AnalyseText(std::string_view text, const std::string& name, double alpha) {
  return ParseTable(text, name).map([&](TableFile file) {
    Analysis analysis = Analyse(std::move(file), alpha);
    analysis.file = std::filesystem::path(name).filename().string();
    analysis.sha256 = Sha256Hex(text);
    return analysis;
  });
}

}  // namespace conav::statistics
