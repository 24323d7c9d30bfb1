#include "study/report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "operator/statistics/report.h"

namespace conav::study {
namespace {

using statistics::ReportSection;

std::string Figure(double value) { return fmt::format("{:.4g}", value); }

std::string Figure(const std::optional<double>& value) { return value ? Figure(*value) : "-"; }

std::string Probability(const std::optional<double>& p) {
  if (!p) return "-";
  return *p != 0.0 && *p < 0.001 ? fmt::format("{:.1e}", *p) : fmt::format("{:.4f}", *p);
}

std::string Count(std::size_t count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

ReportSection TableThree(const StudyReport& report) {
  ReportSection section{.title = "Table 3: mean (SD) over episodes", .header = {"method"}};
  for (const Measure& measure : Measures()) section.header.push_back(measure.header);
  for (const MethodSummary& method : report.summary.methods) {
    std::vector<std::string> row{method.method};
    for (std::size_t m = 0; m < Measures().size(); ++m) {
      const MeanSd& figure = method.measures[m];
      row.push_back(method.episodes > 0 && WasMeasured(report, Measures()[m])
                        ? fmt::format("{:.4g} ({:.3g})", figure.mean, figure.sd)
                        : "-");
    }
    section.rows.push_back(std::move(row));
  }
  section.remarks = {
      "image MiB: every picture counted as 180 KiB, as the paper does; sent MiB: the JPEG bytes" +
          std::string(report.rendered ? "" : " (none: --camera none renders nothing)"),
      "steps of 0.25 s; mapping: share of the map's mistakes put right; goals: share reached"};
  return section;
}

ReportSection BarSection(const StudyReport& report) {
  ReportSection section{.title = "Bars", .header = {"what", "value", "limit", ""}};
  for (const Bar& bar : report.summary.bars) {
    const char* sign = bar.kind == Bar::Kind::kAtLeast  ? ">="
                       : bar.kind == Bar::Kind::kAtMost ? "<="
                                                        : "<";
    section.rows.push_back({bar.text, fmt::format("{:.4f}", bar.value),
                            fmt::format("{} {:.2f}", sign, bar.limit),
                            bar.met() ? "met" : "MISSED"});
  }
  return section;
}

std::vector<std::string> VarianceRow(const Measure& measure, const statistics::Analysis& analysis) {
  const statistics::Anova& anova = analysis.anova;
  std::string epsilon = "-";
  std::string corrected = "-";
  if (anova.sphericity) epsilon = Figure(anova.sphericity->greenhouse_geisser);
  if (anova.greenhouse_geisser) corrected = Probability(anova.greenhouse_geisser->p);
  return {measure.key,
          std::to_string(analysis.table.subject_count()),
          fmt::format("{:g}, {:g}", anova.uncorrected.df_conditions, anova.uncorrected.df_error),
          Figure(anova.f),
          Probability(anova.uncorrected.p),
          epsilon,
          corrected,
          Figure(anova.partial_eta_squared),
          Figure(analysis.friedman.chi_squared),
          Probability(analysis.friedman.p)};
}

ReportSection VarianceSection(const StudyReport& report) {
  ReportSection section{
      .title = "Do the methods differ: means of the simulated operators over their layouts",
      .header = {"measure", "n", "df", "F", "p", "GG epsilon", "GG p", "partial eta^2",
                 "Friedman chi^2", "its p"}};
  for (std::size_t m = 0; m < Measures().size(); ++m) {
    const MeasureAnalysis& measure = report.summary.analyses[m];
    if (!WasMeasured(report, Measures()[m])) continue;
    if (measure.analysis) {
      section.rows.push_back(VarianceRow(Measures()[m], *measure.analysis));
    } else {
      section.remarks.push_back(measure.why_not);
    }
  }
  return section;
}

ReportSection PairSection(const StudyReport& report) {
  ReportSection section{.title = "Which differ: paired t tests, p by Holm over the pairs",
                        .header = {"measure", "pair", "difference", "t", "df", "p", "Holm", "d_z"}};
  for (std::size_t m = 0; m < Measures().size(); ++m) {
    const auto& analysis = report.summary.analyses[m].analysis;
    if (!analysis || !WasMeasured(report, Measures()[m])) continue;
    for (const statistics::Pair& pair : analysis->pairs) {
      section.rows.push_back({Measures()[m].key, pair.first + " - " + pair.second,
                              Figure(pair.t.mean_difference), Figure(pair.t.t),
                              fmt::format("{:g}", pair.t.df), Probability(pair.t.p),
                              Probability(pair.t_adjusted.holm), Figure(pair.t.d_z)});
    }
  }
  return section;
}

std::optional<ReportSection> TroubleSection(const StudyReport& report) {
  ReportSection section{.title = "Episodes that did not reach all goals",
                        .header = {"episode", "status", "attempts", "why", "run folder"}};
  for (const auto* list : {&report.summary.failed, &report.summary.goals_left}) {
    for (const EpisodeRecord* record : *list) {
      section.rows.push_back({record->name, NameOf(record->status),
                              std::to_string(record->attempts), record->detail, record->run});
    }
  }
  if (section.rows.empty()) return std::nullopt;
  if (!report.summary.failed.empty()) {
    section.remarks.push_back(
        "a failed episode has no measures; its operator has no mean for that method and is left "
        "out "
        "of the tests; the same command runs it again");
  }
  return section;
}

}  // namespace

bool WasMeasured(const StudyReport& report, const Measure& measure) {
  return report.rendered || std::string(measure.key) != "sent_mib";
}

std::string Headline(const StudyReport& report) {
  const Design& design = report.design;
  return fmt::format(
      "SIMULATED operators: {} synthetic people x {} x {} = {}; nothing here was measured on "
      "persons",
      design.subjects.size(), Count(design.methods.size(), "method"),
      Count(design.layouts.size(), "layout"), Count(design.episodes.size(), "episode"));
}

std::vector<ReportSection> StudySections(const StudyReport& report) {
  std::vector<ReportSection> sections{TableThree(report), BarSection(report)};
  ReportSection variance = VarianceSection(report);
  ReportSection pairs = PairSection(report);
  if (!variance.rows.empty() || !variance.remarks.empty()) sections.push_back(std::move(variance));
  if (!pairs.rows.empty()) sections.push_back(std::move(pairs));
  if (auto trouble = TroubleSection(report)) sections.push_back(*std::move(trouble));
  return sections;
}

std::string StudyText(const StudyReport& report) {
  std::string text = Headline(report) + "\n";
  for (const ReportSection& section : StudySections(report)) {
    text += statistics::SectionText(section);
  }
  return text;
}

std::string EpisodesCsv(const StudyReport& report) {
  std::string csv =
      "subject,session,task,method,maze_seed,rotation_deg,seed,operator,status,attempts";
  for (const Measure& measure : Measures()) csv += std::string(",") + measure.key;
  csv += ",wall_s\n";
  for (const PlannedEpisode& episode : report.design.episodes) {
    const auto found = report.records.find(episode.name);
    if (found == report.records.end()) continue;
    const EpisodeRecord& record = found->second;
    csv += fmt::format("{},{},{},{},{},{},{},simulated,{},{}",
                       report.design.subjects[static_cast<std::size_t>(episode.subject)],
                       episode.session + 1, episode.task + 1, episode.method, episode.maze_seed,
                       episode.rotation_deg, episode.seed, NameOf(record.status), record.attempts);
    for (const Measure& measure : Measures()) {
      const bool known = record.measures && WasMeasured(report, measure);
      csv += known ? fmt::format(",{}", measure.value(*record.measures)) : ",";
    }
    csv += fmt::format(",{:.3f}\n", record.wall_s);
  }
  return csv;
}

}  // namespace conav::study
