#include "operator/statistics/report_sections.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

namespace conav::statistics {
namespace {

std::string Figure(double value) { return fmt::format("{:.5g}", value == 0.0 ? 0.0 : value); }

std::string Figure(const std::optional<double>& value) { return value ? Figure(*value) : "-"; }

std::string Probability(const std::optional<double>& p) {
  if (!p) return "-";
  if (*p == 0.0) return "0";
  return *p < 0.001 ? fmt::format("{:.2e}", *p) : fmt::format("{:.4f}", *p);
}

std::string Degrees(double df) {
  return df == std::round(df) ? fmt::format("{:.0f}", df) : fmt::format("{:.2f}", df);
}

std::string Range(const Interval& interval) {
  return fmt::format("[{}, {}]", Figure(interval.low), Figure(interval.high));
}

std::string Percent(double alpha) { return fmt::format("{:.4g} %", 100.0 * (1.0 - alpha)); }

ReportSection Conditions(const Analysis& analysis) {
  const std::string percent = Percent(analysis.alpha);
  ReportSection section{.title = "Conditions",
                        .header = {"condition", "n", "mean", "SD", "median", percent + " CI",
                                   percent + " CI within subjects"}};
  for (const Description& row : analysis.conditions) {
    section.rows.push_back({row.condition, std::to_string(row.n), Figure(row.mean),
                            Figure(row.standard_deviation), Figure(row.median),
                            Range(row.mean_interval), Range(row.within_interval)});
  }
  return section;
}

std::vector<std::string> AnovaRow(const std::string& name, const Anova& anova, const FTest& test,
                                  const std::string& epsilon) {
  return {name,
          epsilon,
          Degrees(test.df_conditions),
          Degrees(test.df_error),
          Figure(anova.f),
          Probability(test.p)};
}

/// Below the table: effect sizes and Mauchly's test.
std::vector<std::string> AnovaRemarks(const Anova& anova) {
  std::vector<std::string> remarks{fmt::format("partial eta^2 {}, generalised eta^2 {}",
                                               Figure(anova.partial_eta_squared),
                                               Figure(anova.generalised_eta_squared))};
  if (anova.sphericity && anova.sphericity->mauchly_w) {
    remarks.push_back(fmt::format("sphericity: Mauchly's W {}, p {}",
                                  Figure(anova.sphericity->mauchly_w),
                                  Probability(anova.sphericity->mauchly_p)));
  }
  return remarks;
}

ReportSection Variance(const Analysis& analysis) {
  const Anova& anova = analysis.anova;
  ReportSection section{.title = "Repeated-measures analysis of variance",
                        .header = {"correction", "epsilon", "df", "df error", "F", "p"},
                        .remarks = AnovaRemarks(anova)};
  section.rows.push_back(AnovaRow("none", anova, anova.uncorrected, "1"));
  if (analysis.table.condition_count() == 2 || !anova.sphericity) return section;
  section.rows.push_back(AnovaRow("Greenhouse-Geisser", anova, *anova.greenhouse_geisser,
                                  Figure(anova.sphericity->greenhouse_geisser)));
  if (!anova.huynh_feldt) return section;
  section.rows.push_back(
      AnovaRow("Huynh-Feldt", anova, *anova.huynh_feldt, Figure(anova.sphericity->huynh_feldt)));
  if (const double raw = *anova.sphericity->huynh_feldt_raw; raw > 1.0) {
    section.remarks.push_back(fmt::format("Huynh-Feldt epsilon before min(1, .): {}", Figure(raw)));
  }
  return section;
}

std::string Name(const Pair& pair) { return pair.first + " - " + pair.second; }

ReportSection PairedTests(const Analysis& analysis) {
  ReportSection section{.title = "Pairs: paired t tests",
                        .header = {"pair", "difference", Percent(analysis.alpha) + " CI", "t", "df",
                                   "p", "Holm", "Bonferroni", "BH", "d_z", "d_av", "g_z"}};
  for (const Pair& pair : analysis.pairs) {
    section.rows.push_back(
        {Name(pair), Figure(pair.t.mean_difference), Range(pair.t.interval), Figure(pair.t.t),
         Degrees(pair.t.df), Probability(pair.t.p), Probability(pair.t_adjusted.holm),
         Probability(pair.t_adjusted.bonferroni), Probability(pair.t_adjusted.bh),
         Figure(pair.t.d_z), Figure(pair.t.d_av), Figure(pair.t.g_z)});
  }
  return section;
}

ReportSection Ranks(const Analysis& analysis) {
  const Friedman& friedman = analysis.friedman;
  ReportSection section{
      .title = "Friedman test",
      .header = {"condition", "mean rank"},
      .remarks = {fmt::format("chi^2 {}, df {}, p {}, Kendall's W {}", Figure(friedman.chi_squared),
                              Degrees(friedman.df), Probability(friedman.p),
                              Figure(friedman.kendall_w))}};
  for (std::size_t j = 0; j < analysis.table.condition_count(); ++j) {
    section.rows.push_back({analysis.table.conditions[j], Figure(friedman.mean_ranks[j])});
  }
  return section;
}

ReportSection RankPairs(const Analysis& analysis) {
  ReportSection section{.title = "Pairs: Wilcoxon signed ranks, and normality of the differences",
                        .header = {"pair", "used", "V", "p", "by", "Holm", "Bonferroni", "BH",
                                   "Shapiro-Wilk W", "its p"}};
  for (const Pair& pair : analysis.pairs) {
    const bool tested = pair.wilcoxon.p.has_value();
    section.rows.push_back(
        {Name(pair), std::to_string(pair.wilcoxon.used), Figure(pair.wilcoxon.v),
         Probability(pair.wilcoxon.p), !tested ? "-" : (pair.wilcoxon.exact ? "exact" : "normal"),
         Probability(pair.wilcoxon_adjusted.holm), Probability(pair.wilcoxon_adjusted.bonferroni),
         Probability(pair.wilcoxon_adjusted.bh), pair.normality ? Figure(pair.normality->w) : "-",
         pair.normality ? Probability(pair.normality->p) : "-"});
  }
  return section;
}

}  // namespace

std::string DescribeTable(const Analysis& analysis) {
  return fmt::format("{}: {} subjects, {} conditions", analysis.file,
                     analysis.table.subject_count(), analysis.table.condition_count());
}

std::vector<ReportSection> ReportSections(const Analysis& analysis) {
  return {Conditions(analysis), Variance(analysis), PairedTests(analysis), Ranks(analysis),
          RankPairs(analysis)};
}

}  // namespace conav::statistics
