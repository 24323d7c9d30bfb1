#include "study/statistics/analysis.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <span>
#include <utility>

namespace conav::statistics {
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
                                left.line, fmt::join(left.missing, ", ")));
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

}  // namespace conav::statistics
