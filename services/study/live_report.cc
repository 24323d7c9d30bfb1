#include "study/live_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "common/plot/svg.h"
#include "common/runtime/text.h"
#include "study/statistics/moments.h"
#include "study/statistics/report.h"

namespace conav::study {
namespace {

namespace fs = std::filesystem;

using ConditionOf = std::function<std::string(const LiveTrial&)>;

/// A line per participant that counts: the mean over their trials with each condition.
std::string SubjectCsv(const LiveStudy& study, const LiveMeasure& measure,
                       const std::vector<std::string>& conditions,
                       const ConditionOf& condition_of) {
  std::string csv = "subject";
  for (const std::string& condition : conditions) csv += fmt::format(",{}", CsvText(condition));
  csv += "\n";
  for (const LiveParticipant& participant : study.participants) {
    if (!participant.counts()) continue;
    csv += CsvText(participant.name);
    for (const std::string& condition : conditions) {
      const auto values = ValuesOf(participant, measure, [&](const LiveTrial& trial) {
        return condition_of(trial) == condition;
      });
      csv += CsvCell(values.empty() ? std::nullopt : std::optional(statistics::Mean(values)));
    }
    csv += "\n";
  }
  return csv;
}

ConditionAnalysis AnalyseBy(const LiveStudy& study, const LiveMeasure& measure,
                            const std::vector<std::string>& conditions,
                            const ConditionOf& condition_of, std::string file) {
  ConditionAnalysis result{.file = std::move(file)};
  result.csv = SubjectCsv(study, measure, conditions, condition_of);
  auto analysis = statistics::AnalyseText(result.csv, result.file, statistics::kAlpha);
  if (analysis) {
    result.analysis = *std::move(analysis);
  } else {
    result.why_not = analysis.error().text;
  }
  return result;
}

std::vector<std::string> PositionsIn(const LiveStudy& study) {
  std::size_t most = 0;
  for (const LiveParticipant& participant : study.participants) {
    if (participant.counts()) most = std::max(most, participant.trials.size());
  }
  std::vector<std::string> positions;
  for (std::size_t i = 1; i <= most; ++i) positions.push_back(std::to_string(i));
  return positions;
}

Result<void> CheckMeasures(const std::vector<TestedMeasure>& tested,
                           const std::vector<std::string>& wanted) {
  std::vector<std::string> known;
  for (const TestedMeasure& measure : tested) known.push_back(measure.measure.key);
  for (const std::string& name : wanted) {
    if (name == kAllMeasures || std::ranges::find(known, name) != known.end()) continue;
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--power {}: not a measure that is tested here: {}, or {}", name,
                            Join(known, ", "), kAllMeasures));
  }
  return {};
}

Json AnalysisJson(const ConditionAnalysis& analysis) {
  Json json{{"file", analysis.file}};
  json["analysis"] = analysis.analysis ? statistics::ReportJson(*analysis.analysis) : Json();
  if (!analysis.analysis) json["why_not"] = analysis.why_not;
  return json;
}

Json NeededJson(const statistics::SubjectsNeeded& needed) {
  return {{"power_0_8", needed.for_power ? Json(*needed.for_power) : Json()},
          {"power_0_9", needed.for_high_power ? Json(*needed.for_high_power) : Json()}};
}

Json PlanJson(const statistics::SamplePlan& plan) {
  Json pairs = Json::array();
  for (const statistics::PairPlan& pair : plan.pairs) {
    pairs.push_back({{"first", pair.first},
                     {"second", pair.second},
                     {"d_z", NumberJson(pair.d_z)},
                     {"alone", NeededJson(pair.alone)},
                     {"holm", NeededJson(pair.holm)},
                     {"holm_resampled", NeededJson(pair.holm_resampled)},
                     {"cautious_d_z", NumberJson(pair.cautious_d_z)},
                     {"cautious", NeededJson(pair.cautious)}});
  }
  return {{"pilot_participants", plan.pilot_subjects},
          {"pairs", std::move(pairs)},
          {"anova", NeededJson(plan.anova)},
          {"anova_resampled", NeededJson(plan.anova_resampled)}};
}

Json ParticipantsJson(const LiveStudy& study) {
  Json list = Json::array();
  for (const LiveParticipant& participant : study.participants) {
    Json json{{"participant", participant.name},     {"state", Name(participant.state)},
              {"reason", participant.reason},        {"file", participant.file},
              {"trials", participant.trials.size()}, {"deviations", Json::array()}};
    for (const Deviation& deviation : participant.deviations) {
      json["deviations"].push_back(
          {{"step", deviation.step}, {"what", deviation.text}, {"file", deviation.file}});
    }
    list.push_back(std::move(json));
  }
  return list;
}

/// Over the trials that count, by method.
Json MethodsJson(const LiveReport& report, const LiveMeasure& measure) {
  Json json = Json::object();
  for (const std::string& method : report.study.Methods()) {
    const std::vector<double> values = ValuesOf(report.study, measure, method);
    json[method] = {
        {"trials", values.size()},
        {"mean", values.empty() ? Json() : Json(statistics::Mean(values))},
        {"sd", values.size() < 2 ? Json() : Json(statistics::StandardDeviation(values))}};
  }
  return json;
}

/// The form of all tables: title, header, rows, remarks, files.
Json SectionJson(const ReportSection& section) {
  return {{"title", section.title},
          {"header", section.header},
          {"rows", section.rows},
          {"remarks", section.remarks},
          {"files", section.files}};
}

/// Plot and all figures of a measure.
std::string MeasureHtml(const TestedMeasure& tested) {
  const auto& analysis = tested.by_method.analysis;
  if (!analysis) return {};
  const LiveMeasure& measure = tested.measure;
  AxisLimits limits;
  if (measure.range.starts_with("0 ")) limits.least = 0.0;
  if (measure.is_share()) limits.most = 1.0;
  const std::string label =
      measure.unit.empty() ? measure.title : fmt::format("{} ({})", measure.title, measure.unit);
  std::string html = fmt::format(
      "<h2>{0}</h2>\n{1}<p class=\"muted\">Source: <a href=\"{2}\">{2}</a>, SHA-256 {3}</p>\n"
      "<details>\n<summary>All figures</summary>\n",
      EscapeXml(measure.title), statistics::PlotFigure(*analysis, {label, limits}),
      EscapeXml(tested.by_method.file), EscapeXml(analysis->sha256));
  for (const std::string& note : analysis->notes) html += "<p>" + EscapeXml(note) + "</p>\n";
  return html + SectionsHtml(statistics::ReportSections(*analysis)) + "</details>\n";
}

/// Every trial with its result file.
std::string TrialsHtml(const LiveReport& report) {
  ReportSection section{.title = "Trials",
                        .header = {"participant", "place", "method", "layout", "included", "file"}};
  for (const LiveParticipant& participant : report.study.participants) {
    for (const LiveTrial& trial : participant.trials) {
      section.files.push_back(report.to_study + trial.file);
      section.rows.push_back({participant.name, std::to_string(trial.position), trial.method,
                              trial.layout, participant.counts() ? "yes" : "no",
                              section.files.back()});
    }
  }
  const std::string html = SectionsHtml(std::span(&section, 1));
  return "<details>\n<summary>All trials and their files</summary>\n" + html + "</details>\n";
}

std::string CodebookHtml(const LiveReport& report) {
  ReportSection section{.title = "Codebook of trials.csv",
                        .header = {"column", "meaning", "unit", "range", "source", "empty when"},
                        .remarks = {"NN-STEP: a step's folder below the participant's."},
                        .files = {"trials.csv", "codebook.csv"}};
  for (const LiveColumn& column : report.columns) {
    section.rows.push_back(
        {column.name, column.meaning, column.unit, column.range, column.source, column.missing});
  }
  const std::string html = SectionsHtml(std::span(&section, 1));
  return "<details>\n<summary>Codebook</summary>\n" + html + "</details>\n";
}

}  // namespace

Result<LiveReport> MakeLiveReport(LiveStudy study, const fs::path& out,
                                  const std::vector<std::string>& power, Provenance provenance) {
  LiveReport report{.study = std::move(study), .provenance = std::move(provenance)};
  const std::string way = fs::proximate(fs::absolute(report.study.folder), fs::absolute(out))
                              .lexically_normal()
                              .generic_string();
  if (way != "." && !way.empty()) report.to_study = way.ends_with('/') ? way : way + "/";
  report.measures = LiveMeasures(report.study);
  report.columns = LiveColumns(report.study, report.measures);
  const std::vector<std::string> methods = report.study.Methods();
  const std::vector<std::string> positions = PositionsIn(report.study);
  for (const LiveMeasure& measure : report.measures) {
    if (!measure.tested) continue;
    const std::string file = "measures/" + measure.key;
    report.tested.push_back({.measure = measure,
                             .by_method = AnalyseBy(
                                 report.study, measure, methods,
                                 [](const LiveTrial& t) { return t.method; }, file + ".csv"),
                             .by_position = AnalyseBy(
                                 report.study, measure, positions,
                                 [](const LiveTrial& t) { return std::to_string(t.position); },
                                 file + "-by-position.csv")});
  }
  if (auto known = CheckMeasures(report.tested, power); !known)
    return tl::unexpected(known.error());
  for (TestedMeasure& tested : report.tested) {
    const bool wanted = std::ranges::any_of(power, [&](const std::string& name) {
      return name == kAllMeasures || name == tested.measure.key;
    });
    if (!wanted || !tested.by_method.analysis) continue;
    tested.plan = statistics::PlanSubjects(tested.by_method.analysis->table, statistics::kAlpha);
  }
  return report;
}

std::string LiveHeadline(const LiveReport& report) {
  const LiveStudy& study = report.study;
  std::vector<std::string> parts;
  for (const auto state :
       {ParticipantState::kComplete, ParticipantState::kIncomplete, ParticipantState::kAborted,
        ParticipantState::kMalformed, ParticipantState::kOther}) {
    const std::size_t count = study.CountOf(state);
    if (count > 0) parts.push_back(fmt::format("{} {}", count, Name(state)));
  }
  const auto synthetic =
      std::ranges::count_if(study.participants, [](const LiveParticipant& participant) {
        return participant.design.is_object() && participant.design.value("synthetic", false);
      });
  std::string text =
      fmt::format("{} participants started: {}", study.participants.size(), Join(parts, ", "));
  if (synthetic > 0) text += fmt::format("; {} of them SYNTHETIC, no people", synthetic);
  return text;
}

std::string LiveText(const LiveReport& report) {
  return LiveHeadline(report) + "\n" + SectionsText(LiveSections(report));
}

Json LiveJson(const LiveReport& report) {
  Json json{{"schema", 1},
            {"note", LiveHeadline(report)},
            {"study", report.study.folder.filename().string()},
            {"participants", ParticipantsJson(report.study)},
            {"problems", report.study.problems},
            {"trials_file", "trials.csv"},
            {"codebook_file", "codebook.csv"},
            {"measures", Json::object()},
            {"tests", Json::object()},
            {"tables", Json::array()}};
  for (const LiveMeasure& measure : report.measures) {
    json["measures"][measure.key] = {{"title", measure.title},
                                     {"unit", measure.unit},
                                     {"source", measure.source},
                                     {"methods", MethodsJson(report, measure)}};
  }
  for (const TestedMeasure& tested : report.tested) {
    Json& test = json["tests"][tested.measure.key];
    test = {{"by_method", AnalysisJson(tested.by_method)},
            {"by_position", AnalysisJson(tested.by_position)}};
    if (tested.plan) test["sample_size"] = PlanJson(*tested.plan);
  }
  for (const ReportSection& section : LiveSections(report)) {
    json["tables"].push_back(SectionJson(section));
  }
  return json;
}

std::string LivePage(const LiveReport& report) {
  std::string html = "<p><strong>" + EscapeXml(LiveHeadline(report)) + ".</strong></p>\n" +
                     SectionsHtml(LiveSections(report));
  if (const std::string curves = gaze::CurvesPlot(EyeRecordings(report.study)); !curves.empty()) {
    html += "<h2>Pupil diameter over the trial (figure 4)</h2>\n<figure>" + curves +
            "<figcaption>Mean over participants with its 95 % interval.</figcaption></figure>\n";
  }
  for (const TestedMeasure& tested : report.tested) html += MeasureHtml(tested);
  Json design{{"study", report.study.folder.filename().string()}};
  for (const LiveParticipant& participant : report.study.participants) {
    if (!participant.counts()) continue;
    for (const char* key : {"protocol", "protocol_fingerprint"}) {
      if (participant.design.contains(key)) design[key] = participant.design[key];
    }
    break;
  }
  const ReportSection last[] = {ProvenanceSection(report.provenance, design)};
  return Page("Study with people: " + report.study.folder.filename().string(),
              html + TrialsHtml(report) + CodebookHtml(report) + SectionsHtml(last));
}

std::map<std::string, std::string> LiveFiles(const LiveReport& report) {
  std::map<std::string, std::string> files{
      {"report.html", LivePage(report)},
      {"trials.csv", LiveTrialsCsv(report.study, report.columns)},
      {"codebook.csv", CodebookCsv(report.columns)}};
  for (const TestedMeasure& tested : report.tested) {
    files[tested.by_method.file] = tested.by_method.csv;
    files[tested.by_position.file] = tested.by_position.csv;
  }
  return files;
}

}  // namespace conav::study
