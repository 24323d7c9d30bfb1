#include "study/report.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

#include "common/plot/svg.h"
#include "study/statistics/report.h"

namespace conav::study {
namespace {

std::string Count(std::size_t count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string BreakEvenText(const StudyReport& report) {
  const auto& speed = report.summary.break_even_mps;
  if (!speed)
    return "no speed of teleop in this table takes more and none fewer steps than ig-mcts";
  return fmt::format(
      "teleop takes as many steps as ig-mcts at {:.2f} m/s (its first row: {:g} m/s)", *speed,
      report.design.rows.front().teleop_mps);
}

ReportSection TableThree(const StudyReport& report) {
  ReportSection section{.title = "Table 3: mean (SD) over episodes", .header = {"method"}};
  for (const Measure& measure : Measures()) section.header.push_back(measure.header);
  for (const MethodSummary& method : report.summary.methods) {
    std::vector<std::string> row{method.row.name};
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
          std::string(report.rendered ? "" : " (none: --camera none renders nothing)") +
          "; H.264 MiB: the same with streams as video, encoded afterwards" +
          std::string(report.encoded ? "" : " (--h264)"),
      "steps of 0.25 s; mapping: corrected share of the map's errors; goals: share reached",
      "person s: estimated, see below; greedy ignores the operator, never-send is ig-mcts without "
      "pictures, paper and paper-2000 ig-mcts with the paper's search"};
  if (report.summary.methods.size() > report.design.methods.size()) {
    section.remarks.push_back(BreakEvenText(report));
  }
  return section;
}

/// What the operator's time is, and how long the task takes if robots wait for answers.
ReportSection HumanSection(const StudyReport& report) {
  ReportSection section{
      .title = "Time of the person: counts x times per action, means over episodes, seconds",
      .header = {"method", "middle", "low", "high", "of it robots wait", "task with waits"}};
  const std::size_t time = MeasureIndex("time_s");
  for (const MethodSummary& method : report.summary.methods) {
    const HumanTime& human = method.human;
    std::vector<std::string> row{method.row.name};
    for (const double value : {human.middle, human.low, human.high, human.waiting,
                               method.measures[time].mean + human.waiting}) {
      row.push_back(fmt::format("{:.4g}", value));
    }
    section.rows.push_back(std::move(row));
  }
  const operators::InteractionTimeParameters& times = report.interaction;
  section.remarks = {
      fmt::format(
          "assumed, not measured: a picture {:g} s, a path {:g} s on average, log-normal with "
          "SD {:g} of the logarithm (low, high: 5th and 95th percentile)",
          times.picture_s, times.path_s, times.log_sd),
      fmt::format(
          "a key takes its step; of a stream {:.0f} % of the pictures are looked at (low: none, "
          "high: all of it)",
          100.0 * kGlances)};
  return section;
}

ReportSection ComparableSection(const StudyReport& report) {
  const MeasureAnalysis& steps = report.summary.comparable;
  ReportSection section;
  if (steps.analysis) section = statistics::EquivalenceSection(*steps.analysis);
  section.title = "Comparable: low-level steps of ig-mcts over those of each other row (TOST)";
  if (!steps.analysis) section.remarks.push_back(steps.why_not);
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

/// Nothing for what was not measured, or cannot be analysed.
const statistics::Analysis* AnalysisOf(const StudyReport& report, std::size_t measure) {
  const auto& analysis = report.summary.analyses[measure].analysis;
  return analysis && WasMeasured(report, Measures()[measure]) ? &*analysis : nullptr;
}

/// Whether `b` is `a` in another unit.
bool AreProportional(const std::vector<double>& a, const std::vector<double>& b) {
  const double sum_a = std::accumulate(a.begin(), a.end(), 0.0);
  const double sum_b = std::accumulate(b.begin(), b.end(), 0.0);
  if (a.size() != b.size() || sum_a <= 0.0 || sum_b <= 0.0) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::abs(a[i] / sum_a - b[i] / sum_b) > 1e-12) return false;
  }
  return true;
}

/// A line for each measure that is an earlier one in another unit: its tests are the same.
std::vector<std::string> SameTests(const StudyReport& report) {
  std::vector<std::string> remarks;
  const auto values = [&](std::size_t m) -> const std::vector<double>* {
    const statistics::Analysis* analysis = AnalysisOf(report, m);
    return analysis != nullptr ? &analysis->table.values : nullptr;
  };
  for (std::size_t later = 1; later < Measures().size(); ++later) {
    for (std::size_t m = 0; m < later; ++m) {
      if (values(m) == nullptr || values(later) == nullptr) continue;
      if (!AreProportional(*values(m), *values(later))) continue;
      remarks.push_back(
          fmt::format("{} and {} are one measure in two units here: their tests are the same and "
                      "no further evidence",
                      Measures()[m].header, Measures()[later].header));
      break;
    }
  }
  return remarks;
}

/// Those of Measures() with an analysis.
std::vector<statistics::NamedAnalysis> AnalysesOf(const StudyReport& report) {
  std::vector<statistics::NamedAnalysis> analyses;
  for (std::size_t m = 0; m < Measures().size(); ++m) {
    const statistics::Analysis* analysis = AnalysisOf(report, m);
    if (analysis != nullptr) analyses.push_back({Measures()[m].header, analysis});
  }
  return analyses;
}

ReportSection VarianceSection(const StudyReport& report) {
  ReportSection section = statistics::VarianceOverview(AnalysesOf(report));
  section.title = "Do the methods differ: means of the simulated operators over their layouts";
  for (std::size_t m = 0; m < Measures().size(); ++m) {
    const MeasureAnalysis& measure = report.summary.analyses[m];
    if (WasMeasured(report, Measures()[m]) && !measure.analysis) {
      section.remarks.push_back(measure.why_not);
    }
  }
  for (std::string& remark : SameTests(report)) section.remarks.push_back(std::move(remark));
  return section;
}

ReportSection TroubleSection(const StudyReport& report) {
  ReportSection section{.title = "Episodes that did not reach all goals",
                        .header = {"episode", "status", "attempts", "why", "run folder"}};
  for (const auto* list : {&report.summary.failed, &report.summary.goals_left}) {
    for (const EpisodeRecord* record : *list) {
      section.rows.push_back({record->name, NameOf(record->status),
                              std::to_string(record->attempts), record->detail, record->run});
    }
  }
  if (!report.summary.failed.empty()) {
    section.remarks.push_back(
        "a failed episode has no measures, so the tests leave out its operator; the same command "
        "runs it again");
  }
  return section;
}

using Json = nlohmann::ordered_json;

/// A share is already a mean: its key says so.
std::string MeanKey(const std::string& key) {
  return key == "goals_reached_fraction" ? key : key + "_mean";
}

Json MethodJson(const StudyReport& report, const MethodSummary& method) {
  Json json{{"episodes", method.episodes}, {"episodes_with_all_goals", method.all_goals}};
  for (std::size_t m = 0; m < Measures().size(); ++m) {
    const std::string key = Measures()[m].key;
    const bool known = method.episodes > 0 && WasMeasured(report, Measures()[m]);
    json[MeanKey(key)] = known ? Json(method.measures[m].mean) : Json();
    json[key + "_sd"] = known ? Json(method.measures[m].sd) : Json();
    json[key + "_sd_subjects"] = known ? Json(method.sd_subjects[m]) : Json();
  }
  json["human_time_s_low"] = method.human.low;
  json["human_time_s_high"] = method.human.high;
  json["human_time_s_waiting"] = method.human.waiting;
  return json;
}

Json BarsJson(const std::vector<Bar>& bars) {
  Json list = Json::array();
  for (const Bar& bar : bars) {
    list.push_back({{"key", bar.key},
                    {"text", bar.text},
                    {"value", bar.value},
                    {"limit", bar.limit},
                    {"met", bar.met()}});
  }
  return list;
}

Json TroubleJson(const std::vector<const EpisodeRecord*>& records) {
  Json list = Json::array();
  for (const EpisodeRecord* record : records) list.push_back(ToJson(*record));
  return list;
}

std::string Plot(const Measure& measure, const statistics::Analysis& analysis) {
  const statistics::PlotAxis axis{measure.title, {0.0, measure.is_share ? 1.0 : AxisLimits{}.most}};
  return fmt::format("<h2>{}</h2>\n{}", EscapeXml(measure.title),
                     statistics::PlotFigure(analysis, axis));
}

std::string Tables(const statistics::Analysis& analysis) {
  std::string html = "<details>\n<summary>All figures</summary>\n";
  for (const std::string& note : analysis.notes) html += "<p>" + EscapeXml(note) + "</p>\n";
  return html + SectionsHtml(statistics::ReportSections(analysis)) + "</details>\n";
}

/// The order of methods for each subject.
ReportSection OrderSection(const Design& design) {
  ReportSection section{.title = "Order of the methods (Williams design)", .header = {"operator"}};
  for (std::size_t session = 0; session < design.methods.size(); ++session) {
    section.header.push_back(fmt::format("session {}", session + 1));
  }
  for (std::size_t subject = 0; subject < design.subjects.size(); ++subject) {
    std::vector<std::string> row{design.subjects[subject]};
    std::ranges::copy(Names(design.orders[subject]), std::back_inserter(row));
    section.rows.push_back(std::move(row));
  }
  return section;
}

}  // namespace

bool WasMeasured(const StudyReport& report, const Measure& measure) {
  if (std::string_view(measure.key) == "h264_mib") return report.encoded;
  return report.rendered || std::string_view(measure.key) != "sent_mib";
}

std::string Headline(const StudyReport& report) {
  const Design& design = report.design;
  return fmt::format(
      "SIMULATED operators: {} synthetic people x {} x {} = {}; no measurements of real people",
      design.subjects.size(), Count(design.rows.size(), "row"),
      Count(design.layouts.size(), "layout"), Count(design.episodes.size(), "episode"));
}

std::vector<ReportSection> StudySections(const StudyReport& report) {
  std::vector<ReportSection> sections{TableThree(report), HumanSection(report), BarSection(report)};
  for (ReportSection& section :
       std::array{ComparableSection(report), VarianceSection(report),
                  statistics::PairOverview(AnalysesOf(report)), TroubleSection(report)}) {
    if (!section.rows.empty() || !section.remarks.empty()) sections.push_back(std::move(section));
  }
  return sections;
}

std::string StudyText(const StudyReport& report) {
  return Headline(report) + "\n" + SectionsText(StudySections(report));
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
                       episode.session + 1, episode.task + 1, episode.row.name, episode.maze_seed,
                       episode.rotation_deg, episode.seed, NameOf(record.status), record.attempts);
    for (const Measure& measure : Measures()) {
      const bool known = record.measures && WasMeasured(report, measure);
      csv += CsvCell(known ? std::optional(measure.value(*record.measures)) : std::nullopt);
    }
    csv += fmt::format(",{:.3f}\n", record.wall_s);
  }
  return csv;
}

Json StudyJson(const StudyReport& report) {
  const StudySummary& summary = report.summary;
  Json json{{"schema", 1},
            {"simulated", true},
            {"note", Headline(report)},
            {"design", report.document},
            {"methods", Json::object()},
            {"bars", BarsJson(summary.bars)},
            {"failed", TroubleJson(summary.failed)},
            {"goals_left", TroubleJson(summary.goals_left)},
            {"analyses", Json::object()}};
  for (const MethodSummary& method : summary.methods) {
    json["methods"][method.row.name] = MethodJson(report, method);
  }
  for (std::size_t m = 0; m < Measures().size(); ++m) {
    const statistics::Analysis* analysis = AnalysisOf(report, m);
    json["analyses"][Measures()[m].key] = analysis ? statistics::ReportJson(*analysis) : Json();
  }
  json["teleop_break_even_mps"] = NumberJson(summary.break_even_mps);
  json["comparable"] = Json::object();
  if (!summary.comparable.analysis) return json;
  for (const statistics::Pair& pair : summary.comparable.analysis->pairs) {
    if (pair.equivalence) json["comparable"][pair.second] = EquivalenceJson(*pair.equivalence);
  }
  return json;
}

std::string StudyPage(const StudyReport& report) {
  std::string html = "<p><strong>" + EscapeXml(Headline(report)) + ".</strong></p>\n" +
                     SectionsHtml(StudySections(report));
  for (std::size_t m = 0; m < Measures().size(); ++m) {
    const statistics::Analysis* analysis = AnalysisOf(report, m);
    if (analysis == nullptr) continue;
    html += Plot(Measures()[m], *analysis) + Tables(*analysis);
  }
  const ReportSection last[] = {OrderSection(report.design),
                                ProvenanceSection(report.provenance, report.document)};
  return Page("Study with simulated operators", html + SectionsHtml(last));
}

}  // namespace conav::study
