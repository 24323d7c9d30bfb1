#include "study/statistics/report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace conav::statistics {
namespace {

using study::NumberJson;
using study::ReportSection;

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

/// Remarks below the table: effect sizes and Mauchly's test.
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

std::string SubjectsText(const Equivalence& equivalence) {
  return equivalence.subjects ? std::to_string(*equivalence.subjects)
                              : fmt::format("over {}", kMostSubjectsForPower);
}

ReportSection FriedmanTest(const Analysis& analysis) {
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

using Json = nlohmann::ordered_json;

Json LeftOutJson(const Analysis& analysis) {
  Json list = Json::array();
  for (const LeftOut& left : analysis.left_out) {
    list.push_back({{"subject", left.subject}, {"line", left.line}, {"missing", left.missing}});
  }
  return list;
}

Json ConditionsJson(const Analysis& analysis) {
  Json list = Json::array();
  for (std::size_t j = 0; j < analysis.conditions.size(); ++j) {
    const Description& row = analysis.conditions[j];
    list.push_back({{"condition", row.condition},
                    {"n", row.n},
                    {"mean", row.mean},
                    {"sd", row.standard_deviation},
                    {"median", row.median},
                    {"ci_low", row.mean_interval.low},
                    {"ci_high", row.mean_interval.high},
                    {"within_ci_low", row.within_interval.low},
                    {"within_ci_high", row.within_interval.high},
                    {"mean_rank", analysis.friedman.mean_ranks[j]}});
  }
  return list;
}

Json CorrectionJson(const std::optional<double>& epsilon, const std::optional<FTest>& test) {
  Json json;
  json["epsilon"] = NumberJson(epsilon);
  json["df_conditions"] = test ? Json(test->df_conditions) : Json();
  json["df_error"] = test ? Json(test->df_error) : Json();
  json["p"] = test ? NumberJson(test->p) : Json();
  return json;
}

Json AnovaJson(const Anova& anova) {
  Sphericity none{.huynh_feldt_raw = {}, .huynh_feldt = {}};
  const Sphericity& sphericity = anova.sphericity ? *anova.sphericity : none;
  const auto epsilon =
      anova.sphericity ? std::optional(sphericity.greenhouse_geisser) : std::nullopt;
  Json json;
  json["ss_conditions"] = anova.ss_conditions;
  json["ss_subjects"] = anova.ss_subjects;
  json["ss_error"] = anova.ss_error;
  json["f"] = NumberJson(anova.f);
  json["df_conditions"] = anova.uncorrected.df_conditions;
  json["df_error"] = anova.uncorrected.df_error;
  json["p"] = NumberJson(anova.uncorrected.p);
  json["greenhouse_geisser"] = CorrectionJson(epsilon, anova.greenhouse_geisser);
  json["huynh_feldt"] = CorrectionJson(sphericity.huynh_feldt, anova.huynh_feldt);
  json["huynh_feldt"]["epsilon_raw"] = NumberJson(sphericity.huynh_feldt_raw);
  json["mauchly"] = {{"w", NumberJson(sphericity.mauchly_w)},
                     {"p", NumberJson(sphericity.mauchly_p)}};
  json["partial_eta_squared"] = NumberJson(anova.partial_eta_squared);
  json["generalised_eta_squared"] = NumberJson(anova.generalised_eta_squared);
  return json;
}

void AddAdjusted(Json& json, const AdjustedP& adjusted) {
  json["p_holm"] = NumberJson(adjusted.holm);
  json["p_bonferroni"] = NumberJson(adjusted.bonferroni);
  json["p_bh"] = NumberJson(adjusted.bh);
}

Json WilcoxonJson(const Pair& pair) {
  Json json;
  json["used"] = pair.wilcoxon.used;
  json["exact"] = pair.wilcoxon.exact;
  json["v"] = NumberJson(pair.wilcoxon.v);
  json["p"] = NumberJson(pair.wilcoxon.p);
  AddAdjusted(json, pair.wilcoxon_adjusted);
  return json;
}

Json PairJson(const Pair& pair) {
  Json json;
  json["first"] = pair.first;
  json["second"] = pair.second;
  json["mean_difference"] = pair.t.mean_difference;
  json["ci_low"] = pair.t.interval.low;
  json["ci_high"] = pair.t.interval.high;
  json["t"] = NumberJson(pair.t.t);
  json["df"] = pair.t.df;
  json["p"] = NumberJson(pair.t.p);
  AddAdjusted(json, pair.t_adjusted);
  json["d_z"] = NumberJson(pair.t.d_z);
  json["d_av"] = NumberJson(pair.t.d_av);
  json["g_z"] = NumberJson(pair.t.g_z);
  json["wilcoxon"] = WilcoxonJson(pair);
  json["shapiro_wilk"] = {{"w", pair.normality ? Json(pair.normality->w) : Json()},
                          {"p", pair.normality ? Json(pair.normality->p) : Json()}};
  if (pair.equivalence) json["equivalence"] = EquivalenceJson(*pair.equivalence);
  return json;
}

Json FriedmanJson(const Friedman& friedman) {
  return {{"chi_squared", NumberJson(friedman.chi_squared)},
          {"df", friedman.df},
          {"p", NumberJson(friedman.p)},
          {"kendall_w", NumberJson(friedman.kendall_w)}};
}

constexpr double kLeft = 72.0;
constexpr double kRight = 16.0;
constexpr double kTop = 12.0;
constexpr double kHeight = 320.0;  // of the axis
constexpr double kBelow = 32.0;
constexpr double kConditionWidth = 120.0;
constexpr std::size_t kMostLetters = 16;

constexpr int kTicks = 6;

/// The conditions from left to right, each in the middle of a unit of x.
PlotArea AreaFor(const Analysis& analysis, const AxisLimits& limits) {
  const auto [least, most] =
      std::minmax_element(analysis.table.values.begin(), analysis.table.values.end());
  double low = *least;
  double high = *most;
  for (const Description& row : analysis.conditions) {
    low = std::min({low, row.mean_interval.low, row.within_interval.low});
    high = std::max({high, row.mean_interval.high, row.within_interval.high});
  }
  const auto conditions = static_cast<double>(analysis.table.condition_count());
  const Axis y = RoundAxis(low, high, kTicks, limits);
  const double width = kConditionWidth * conditions;
  return {{kLeft, kTop}, width, kHeight, {0.0, conditions, 0.0}, y, {}, kLeft - 14.0};
}

double MiddleOf(std::size_t condition) { return static_cast<double>(condition) + 0.5; }

/// At most kMostLetters characters of UTF-8.
std::string Shortened(const std::string& name) {
  std::size_t letters = 0;
  for (std::size_t i = 0; i < name.size(); ++i) {
    if ((static_cast<unsigned>(name[i]) & 0xC0U) == 0x80U) continue;
    if (++letters > kMostLetters) return name.substr(0, i) + "...";
  }
  return name;
}

void DrawSubjects(SvgCanvas& canvas, const PlotArea& area, const ConditionTable& table) {
  for (std::size_t i = 0; i < std::min(table.subject_count(), kMostLines); ++i) {
    std::vector<PixelPosition> line;
    for (std::size_t j = 0; j < table.condition_count(); ++j) {
      line.push_back(area.At(MiddleOf(j), table.At(i, j)));
    }
    canvas.BeginGroup(table.subjects[i]);
    canvas.Polyline(line, "class=\"subject\"");
    canvas.EndGroup();
  }
}

void DrawMean(SvgCanvas& canvas, const PlotArea& area, double x, const Description& row) {
  canvas.BeginGroup(
      fmt::format("{}: mean {:.5g} [{:.5g}, {:.5g}], within subjects [{:.5g}, {:.5g}]",
                  row.condition, row.mean, row.mean_interval.low, row.mean_interval.high,
                  row.within_interval.low, row.within_interval.high));
  for (const double end : {row.mean_interval.low, row.mean_interval.high}) {
    if (!area.y.Has(end)) continue;  // the interval extends beyond the possible values
    const PixelPosition at = area.At(x, end);
    canvas.Line({at.x - 7, at.y}, {at.x + 7, at.y}, "class=\"interval\"");
  }
  const auto draw = [&](const Interval& interval, const char* style) {
    canvas.Line(area.At(x, interval.low), area.At(x, interval.high), style);
  };
  draw(row.mean_interval, "class=\"interval\"");
  draw(row.within_interval, "class=\"within\"");
  canvas.Circle(area.At(x, row.mean), 5, "class=\"mean\"");
  area.DrawTickX(canvas, x, Shortened(row.condition));
  canvas.EndGroup();
}

std::string DescribeTable(const Analysis& analysis) {
  return fmt::format("{}: {} subjects, {} conditions", analysis.file,
                     analysis.table.subject_count(), analysis.table.condition_count());
}

std::string Facts(const Analysis& analysis) {
  std::string html = fmt::format("<p>{}</p>\n<p class=\"muted\">SHA-256 of the data: {}</p>\n",
                                 EscapeXml(DescribeTable(analysis)), EscapeXml(analysis.sha256));
  if (analysis.notes.empty()) return html;
  html += "<ul>\n";
  for (const std::string& note : analysis.notes) html += "<li>" + EscapeXml(note) + "</li>\n";
  return html + "</ul>\n";
}

/// Four digits, for tables of many measures.
std::string Short(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? fmt::format("{:.4g}", *value) : "-";
}

std::string ShortP(const std::optional<double>& p) {
  if (!p) return "-";
  return *p != 0.0 && *p < 0.001 ? fmt::format("{:.1e}", *p) : fmt::format("{:.4f}", *p);
}

/// Without spread the test is meaningless, whatever its formula gives.
bool HasTest(const std::optional<double>& statistic) {
  return statistic && std::isfinite(*statistic);
}

std::vector<std::string> VarianceRow(const NamedAnalysis& named) {
  const Analysis& analysis = *named.analysis;
  const Anova& anova = analysis.anova;
  return {named.name,
          std::to_string(analysis.table.subject_count()),
          fmt::format("{:g}, {:g}", anova.uncorrected.df_conditions, anova.uncorrected.df_error),
          Short(anova.f),
          HasTest(anova.f) ? ShortP(anova.uncorrected.p) : "-",
          anova.sphericity ? Short(anova.sphericity->greenhouse_geisser) : "-",
          anova.greenhouse_geisser ? ShortP(anova.greenhouse_geisser->p) : "-",
          Short(anova.partial_eta_squared),
          Short(analysis.friedman.chi_squared),
          ShortP(analysis.friedman.p)};
}

std::vector<std::string> PairRow(const std::string& name, const Pair& pair) {
  const bool has_test = HasTest(pair.t.t);
  return {name,
          Name(pair),
          Short(pair.t.mean_difference),
          fmt::format("[{}, {}]", Short(pair.t.interval.low), Short(pair.t.interval.high)),
          Short(pair.t.t),
          fmt::format("{:g}", pair.t.df),
          has_test ? ShortP(pair.t.p) : "-",
          has_test ? ShortP(pair.t_adjusted.holm) : "-",
          Short(pair.t.d_z)};
}

}  // namespace

ReportSection VarianceOverview(std::span<const NamedAnalysis> analyses) {
  ReportSection section{.title = "Do the conditions differ",
                        .header = {"measure", "n", "df", "F", "p", "GG epsilon", "GG p",
                                   "partial eta^2", "Friedman chi^2", "its p"}};
  for (const NamedAnalysis& named : analyses) {
    section.rows.push_back(VarianceRow(named));
    if (HasTest(named.analysis->anova.f)) continue;
    section.remarks.push_back(fmt::format(
        "{}: no F: the conditions differ by the same amount, or not at all, for every subject",
        named.name));
  }
  return section;
}

ReportSection PairOverview(std::span<const NamedAnalysis> analyses) {
  ReportSection section{
      .title = "Which differ: paired t tests, p by Holm over the pairs",
      .header = {"measure", "pair", "difference", "95 % CI", "t", "df", "p", "Holm", "d_z"}};
  bool lacks_tests = false;
  for (const NamedAnalysis& named : analyses) {
    for (const Pair& pair : named.analysis->pairs) {
      section.rows.push_back(PairRow(named.name, pair));
      lacks_tests = lacks_tests || !HasTest(pair.t.t);
    }
  }
  if (lacks_tests) {
    section.remarks = {"t -: the difference is the same for every subject, nothing to test"};
  }
  return section;
}

ReportSection EquivalenceSection(const Analysis& analysis) {
  ReportSection section{.title = "Equivalence: two one-sided tests of the ratio of means (TOST)",
                        .header = {"pair", "ratio", Percent(2.0 * analysis.alpha) + " CI", "within",
                                   "p", "equivalent", "subjects for power 0.8"}};
  for (const Pair& pair : analysis.pairs) {
    if (!pair.equivalence) continue;
    const Equivalence& test = *pair.equivalence;
    section.rows.push_back({pair.first + " / " + pair.second, Figure(test.ratio),
                            test.interval ? Range(*test.interval) : "-",
                            fmt::format("1 -+ {:g}", test.margin), Probability(test.p),
                            test.is_shown ? "yes" : "not shown", SubjectsText(test)});
  }
  return section;
}

Json EquivalenceJson(const Equivalence& test) {
  return {{"margin", test.margin},
          {"ratio", NumberJson(test.ratio)},
          {"ci_low", test.interval ? Json(test.interval->low) : Json()},
          {"ci_high", test.interval ? Json(test.interval->high) : Json()},
          {"p", test.p},
          {"equivalent", test.is_shown},
          {"subjects_for_power_0_8", test.subjects ? Json(*test.subjects) : Json()}};
}

std::vector<study::ReportSection> ReportSections(const Analysis& analysis) {
  std::vector<ReportSection> sections{Conditions(analysis), Variance(analysis),
                                      PairedTests(analysis), FriedmanTest(analysis),
                                      RankPairs(analysis)};
  ReportSection equivalence = EquivalenceSection(analysis);
  if (!equivalence.rows.empty()) sections.push_back(std::move(equivalence));
  return sections;
}

Json ReportJson(const Analysis& analysis) {
  Json json;
  json["schema"] = 1;
  json["file"] = analysis.file;
  json["sha256"] = analysis.sha256;
  json["alpha"] = analysis.alpha;
  json["subjects"] = analysis.table.subjects;
  json["left_out"] = LeftOutJson(analysis);
  json["conditions"] = ConditionsJson(analysis);
  json["anova"] = AnovaJson(analysis.anova);
  json["pairs"] = Json::array();
  for (const Pair& pair : analysis.pairs) json["pairs"].push_back(PairJson(pair));
  json["friedman"] = FriedmanJson(analysis.friedman);
  json["notes"] = analysis.notes;
  return json;
}

std::string ReportText(const Analysis& analysis) {
  std::string text = DescribeTable(analysis) + "\n";
  for (const std::string& note : analysis.notes) text += "Note: " + note + "\n";
  return text + study::SectionsText(ReportSections(analysis));
}

std::string ConditionsPlot(const Analysis& analysis, const PlotAxis& values) {
  SvgCanvas canvas;
  const PlotArea area = AreaFor(analysis, values.limits);
  area.Draw(canvas, "", values.label);
  DrawSubjects(canvas, area, analysis.table);
  std::string title = "Means of the conditions:";
  for (std::size_t j = 0; j < analysis.conditions.size(); ++j) {
    DrawMean(canvas, area, MiddleOf(j), analysis.conditions[j]);
    title +=
        fmt::format(" {} {:.5g}", analysis.conditions[j].condition, analysis.conditions[j].mean);
  }
  return canvas.Inline(kLeft + area.width + kRight, kTop + kHeight + kBelow, title);
}

std::string PlotFigure(const Analysis& analysis, const PlotAxis& values) {
  std::string caption = fmt::format(
      "Blue: mean and its {0:.4g} % confidence interval. Orange: the {0:.4g} % interval within "
      "subjects, for comparing conditions. Grey: a line per subject",
      100.0 * (1.0 - analysis.alpha));
  if (analysis.table.subject_count() > kMostLines) {
    caption += fmt::format(", the first {}", kMostLines);
  }
  return fmt::format(
      "<figure>\n<div class=\"wide\" tabindex=\"0\">\n{}</div>\n<figcaption>{}.</figcaption>\n"
      "</figure>\n",
      ConditionsPlot(analysis, values), EscapeXml(caption));
}

std::string ReportPage(const Analysis& analysis) {
  return study::Page(
      "Repeated measures: " + analysis.file,
      Facts(analysis) + PlotFigure(analysis) + study::SectionsHtml(ReportSections(analysis)));
}

}  // namespace conav::statistics
