#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "common/runtime/text.h"
#include "study/live_report.h"
#include "study/statistics/moments.h"
#include "study/statistics/report.h"

namespace conav::study {
namespace {

constexpr std::size_t kMostKinds = 8;       // of answers, that a table counts
constexpr std::size_t kLongestAnswer = 40;  // in characters; longer ones are texts

std::string MeanText(const std::vector<double>& values) {
  if (values.empty()) return "-";
  if (values.size() == 1) return fmt::format("{:.4g}", values[0]);
  return fmt::format("{:.4g} ({:.3g})", statistics::Mean(values),
                     statistics::StandardDeviation(values));
}

std::string TitleOf(const LiveMeasure& measure) {
  return measure.unit.empty() ? measure.key : fmt::format("{}, {}", measure.key, measure.unit);
}

ReportSection ParticipantSection(const LiveReport& report) {
  ReportSection section{.title = "Participants",
                        .header = {"participant", "state", "trials", "order", "why", "file"}};
  for (const LiveParticipant& participant : report.study.participants) {
    const std::string order =
        participant.design.contains("order") ? AnswerText(participant.design["order"]) : "-";
    const std::string file = report.to_study + participant.file;
    section.rows.push_back({participant.name, Name(participant.state),
                            std::to_string(participant.trials.size()), order, participant.reason,
                            file});
    section.files.push_back(file);
  }
  section.remarks = {
      "Tables and tests take the participants whose protocol is complete. The others stay in "
      "trials.csv, where included is no. Failed attention checks and deviations exclude nobody; "
      "--participants chooses."};
  for (const std::string& problem : report.study.problems) section.remarks.push_back(problem);
  return section;
}

ReportSection TableThree(const LiveReport& report) {
  ReportSection section{.title = "Table 3: mean (SD) over trials",
                        .header = {"measure", "what"},
                        .files = {"trials.csv"}};
  const std::vector<std::string> methods = report.study.Methods();
  section.header.insert(section.header.end(), methods.begin(), methods.end());
  std::vector<std::string> counts{"trials", "Number of trials"};
  for (const std::string& method : methods) {
    std::ptrdiff_t trials = 0;
    for (const LiveParticipant& participant : report.study.participants) {
      if (!participant.counts()) continue;
      trials += std::ranges::count(participant.trials, method, &LiveTrial::method);
    }
    counts.push_back(std::to_string(trials));
  }
  section.rows.push_back(std::move(counts));
  for (const LiveMeasure& measure : report.measures) {
    const bool is_shown = measure.tested || measure.key == "image_mib";
    if (measure.kind != LiveMeasure::Kind::kTask || !is_shown) continue;
    std::vector<std::string> row{TitleOf(measure), measure.title};
    for (const std::string& method : methods) {
      row.push_back(MeanText(ValuesOf(report.study, measure, method)));
    }
    section.rows.push_back(std::move(row));
  }
  return section;
}

/// Of one part of the tested measures: those by method, or those by position.
std::vector<statistics::NamedAnalysis> AnalysesOf(const LiveReport& report,
                                                  ConditionAnalysis TestedMeasure::*part) {
  std::vector<statistics::NamedAnalysis> analyses;
  for (const TestedMeasure& tested : report.tested) {
    const auto& analysis = (tested.*part).analysis;
    if (analysis) analyses.push_back({tested.measure.key, &*analysis});
  }
  return analyses;
}

/// Notes who is left out of which test, and why there is none.
void AddSources(const LiveReport& report, ConditionAnalysis TestedMeasure::*part,
                ReportSection& section) {
  for (const TestedMeasure& tested : report.tested) {
    const ConditionAnalysis& analysis = tested.*part;
    section.files.push_back(analysis.file);
    if (!analysis.analysis) section.remarks.push_back(analysis.why_not);
    if (!analysis.analysis) continue;
    for (const statistics::LeftOut& left : analysis.analysis->left_out) {
      section.remarks.push_back(fmt::format("{}: without {}, who has no value in {}",
                                            tested.measure.key, left.subject,
                                            Join(left.missing, ", ")));
    }
  }
}

ReportSection VarianceSection(const LiveReport& report) {
  ReportSection section =
      statistics::VarianceOverview(AnalysesOf(report, &TestedMeasure::by_method));
  section.title = "Do the methods differ: repeated-measures ANOVA of the participants' means";
  AddSources(report, &TestedMeasure::by_method, section);
  section.remarks.emplace_back(
      "p of each measure by itself: nothing corrects for the number of measures. Below, each "
      "measure has its plot and all figures.");
  return section;
}

ReportSection PairSection(const LiveReport& report) {
  ReportSection section = statistics::PairOverview(AnalysesOf(report, &TestedMeasure::by_method));
  for (const TestedMeasure& tested : report.tested) section.files.push_back(tested.by_method.file);
  return section;
}

ReportSection OrderSection(const LiveReport& report) {
  ReportSection section =
      statistics::VarianceOverview(AnalysesOf(report, &TestedMeasure::by_position));
  section.title = "Order effects: do the places differ, whatever the method";
  section.header[0] = "measure by position";
  // The means of the places stand before the tests.
  for (std::size_t row = 0; row < section.rows.size(); ++row) {
    const auto analyses = AnalysesOf(report, &TestedMeasure::by_position);
    std::vector<std::string> means;
    for (const statistics::Description& place : analyses[row].analysis->conditions) {
      means.push_back(fmt::format("{:.4g}", place.mean));
    }
    section.rows[row].insert(section.rows[row].begin() + 1, Join(means, " / "));
  }
  section.header.insert(section.header.begin() + 1, "means of places 1 / 2 / ...");
  AddSources(report, &TestedMeasure::by_position, section);
  return section;
}

ReportSection QuestionnaireSection(const LiveReport& report) {
  ReportSection section{.title = "Questionnaires: mean (SD) over participants",
                        .header = {"score or item", "question"},
                        .files = {"trials.csv"}};
  const std::vector<std::string> methods = report.study.Methods();
  section.header.insert(section.header.end(), methods.begin(), methods.end());
  for (const LiveMeasure& measure : report.measures) {
    if (measure.kind != LiveMeasure::Kind::kScore && measure.kind != LiveMeasure::Kind::kItem) {
      continue;
    }
    std::vector<std::string> row{measure.key, measure.title};
    for (const std::string& method : methods) {
      std::vector<double> means;
      for (const LiveParticipant& participant : report.study.participants) {
        if (!participant.counts()) continue;
        const auto values = ValuesOf(
            participant, measure, [&](const LiveTrial& trial) { return trial.method == method; });
        if (!values.empty()) means.push_back(statistics::Mean(values));
      }
      row.push_back(MeanText(means));
    }
    section.rows.push_back(std::move(row));
  }
  if (section.rows.empty()) section.remarks.emplace_back("No questionnaire after a method.");
  return section;
}

std::vector<ReportSection> EyeSections(const LiveReport& report) {
  const std::vector<gaze::MeasuredRecording> recordings = EyeRecordings(report.study);
  if (recordings.empty()) {
    return {{.title = "Eye measures (table 2)", .remarks = {"No eye tracker was recorded."}}};
  }
  std::vector<ReportSection> sections = gaze::GazeSections(recordings);
  sections.front().title = "Table 2: eye measures, mean (SD) over participants";
  sections.back().title = "Eye measures that do not count";
  for (ReportSection& section : sections) section.files = {"trials.csv"};
  return sections;
}

/// n, mean, SD and range of numbers; how often there is each of a few short answers.
std::string Summary(const std::vector<Json>& answers, const std::vector<double>& numbers) {
  if (numbers.size() == answers.size() && !numbers.empty()) {
    return fmt::format("{}, {:g} to {:g}", MeanText(numbers), std::ranges::min(numbers),
                       std::ranges::max(numbers));
  }
  std::map<std::string, int> counts;
  for (const Json& answer : answers) {
    if (!answer.is_array()) ++counts[OneLine(AnswerText(answer))];
    if (!answer.is_array()) continue;
    for (const Json& part : answer) ++counts[OneLine(AnswerText(part))];
  }
  const bool is_text = std::ranges::any_of(
      counts, [](const auto& count) { return count.first.size() > kLongestAnswer; });
  if (is_text || counts.size() > kMostKinds) return "texts, see trials.csv";
  std::vector<std::string> parts;
  for (const auto& [answer, count] : counts) parts.push_back(fmt::format("{}: {}", answer, count));
  return Join(parts, ", ");
}

ReportSection DemographicsSection(const LiveReport& report) {
  ReportSection section{.title = "Answers about the participants",
                        .header = {"form", "question", "n", "answers: mean (SD), range; or counts"},
                        .files = {"trials.csv"}};
  for (const LiveQuestion& question : QuestionsIn(report.study, false)) {
    std::vector<Json> answers;
    std::vector<double> numbers;
    for (const LiveParticipant& participant : report.study.participants) {
      const LiveForm* form = FormIn(participant.forms, question.form);
      if (!participant.counts() || form == nullptr) continue;
      if (!form->answers.contains(question.name) || form->answers[question.name].is_null())
        continue;
      answers.push_back(form->answers[question.name]);
      if (const auto number = form->Number(question.name)) numbers.push_back(*number);
    }
    section.rows.push_back({question.form,
                            QuestionTitle(report.study, question.form, question.name),
                            std::to_string(answers.size()), Summary(answers, numbers)});
  }
  if (section.rows.empty()) section.remarks.emplace_back("No such form.");
  return section;
}

ReportSection AttentionSection(const LiveReport& report) {
  ReportSection section{.title = "Attention checks",
                        .header = {"participant", "passed", "failed in steps", "file"}};
  for (const LiveParticipant& participant : report.study.participants) {
    std::map<std::string, const LiveForm*> checks;  // by step: a form may belong to several trials
    const auto add = [&](const LiveForm& form) {
      if (form.attention_passed) checks[form.step] = &form;
    };
    std::ranges::for_each(participant.forms, add);
    for (const LiveTrial& trial : participant.trials) std::ranges::for_each(trial.forms, add);
    if (checks.empty()) continue;
    std::vector<std::string> failed;
    std::string file = report.to_study + participant.name + "/result.json";
    for (const auto& [step, form] : checks) {
      if (*form->attention_passed) continue;
      if (failed.empty()) file = report.to_study + form->file;
      failed.push_back(step);
    }
    section.rows.push_back({participant.name,
                            fmt::format("{} of {}", checks.size() - failed.size(), checks.size()),
                            failed.empty() ? "-" : Join(failed, ", "), file});
    section.files.push_back(file);
  }
  if (section.rows.empty()) section.remarks.emplace_back("No form has one.");
  return section;
}

ReportSection DeviationSection(const LiveReport& report) {
  ReportSection section{.title = "Deviations from the protocol",
                        .header = {"participant", "step", "what", "file"}};
  for (const LiveParticipant& participant : report.study.participants) {
    for (const Deviation& deviation : participant.deviations) {
      const std::string file = report.to_study + deviation.file;
      section.rows.push_back(
          {participant.name, deviation.step.empty() ? "-" : deviation.step, deviation.text, file});
      section.files.push_back(file);
    }
  }
  if (section.rows.empty()) section.remarks.emplace_back("None.");
  return section;
}

/// "12 / 16": for a power of 0.8 and of 0.9.
std::string NeededText(const statistics::SubjectsNeeded& needed) {
  const auto text = [](const std::optional<int>& subjects) {
    return subjects ? std::to_string(*subjects)
                    : fmt::format("over {}", statistics::kMostSubjectsForPower);
  };
  return fmt::format("{} / {}", text(needed.for_power), text(needed.for_high_power));
}

std::string FigureText(const std::optional<double>& value) {
  return value ? fmt::format("{:.3g}", *value) : "-";
}

ReportSection PlanSection(const TestedMeasure& tested) {
  const statistics::SamplePlan& plan = *tested.plan;
  ReportSection section{
      .title = fmt::format("Participants for a power of 0.8 / 0.9: {}", tested.measure.key),
      .header = {"test", "d_z", "by Holm", "by Holm, resampled", "as the only test", "cautious d_z",
                 "for the cautious d_z"},
      .files = {tested.by_method.file}};
  for (const statistics::PairPlan& pair : plan.pairs) {
    section.rows.push_back({pair.first + " - " + pair.second, FigureText(pair.d_z),
                            NeededText(pair.holm), NeededText(pair.holm_resampled),
                            NeededText(pair.alone), FigureText(pair.cautious_d_z),
                            pair.cautious_d_z ? NeededText(pair.cautious) : "-"});
  }
  section.rows.push_back({"ANOVA, Greenhouse-Geisser", "-", NeededText(plan.anova),
                          NeededText(plan.anova_resampled), "-", "-", "-"});
  section.remarks = {
      fmt::format("Simulated from the {} participants of this pilot as if its differences were the "
                  "true ones: 2,000 studies of each size, normal values with its means and "
                  "covariance, or its participants drawn again.",
                  plan.pilot_subjects),
      "A pilot's differences are uncertain, and large ones are studied further more often: plan "
      "with "
      "the cautious d_z, the lower end of its 60 % interval (alpha divided by the number of "
      "pairs), "
      "or with the smallest difference that matters. -: the pilot does not tell its direction."};
  return section;
}

}  // namespace

std::vector<double> ValuesOf(const LiveParticipant& participant, const LiveMeasure& measure,
                             const std::function<bool(const LiveTrial&)>& is_wanted) {
  std::vector<double> values;
  for (const LiveTrial& trial : participant.trials) {
    const auto value = measure.value(trial);
    if (value && is_wanted(trial)) values.push_back(*value);
  }
  return values;
}

std::vector<double> ValuesOf(const LiveStudy& study, const LiveMeasure& measure,
                             const std::string& method) {
  std::vector<double> all;
  for (const LiveParticipant& participant : study.participants) {
    if (!participant.counts()) continue;
    std::ranges::copy(ValuesOf(participant, measure,
                               [&](const LiveTrial& trial) { return trial.method == method; }),
                      std::back_inserter(all));
  }
  return all;
}

std::vector<gaze::MeasuredRecording> EyeRecordings(const LiveStudy& study) {
  std::vector<gaze::MeasuredRecording> recordings;
  for (const LiveParticipant& participant : study.participants) {
    if (!participant.counts()) continue;
    gaze::MeasuredRecording recording{.file = participant.name, .participant = participant.name};
    for (const LiveTrial& trial : participant.trials) {
      if (!trial.eye) continue;
      recording.trials.push_back(*trial.eye);
      recording.trials.back().trial.keys["method"] = trial.method;
    }
    if (!recording.trials.empty()) recordings.push_back(std::move(recording));
  }
  return recordings;
}

std::vector<ReportSection> LiveSections(const LiveReport& report) {
  std::vector<ReportSection> sections{ParticipantSection(report), TableThree(report),
                                      VarianceSection(report), PairSection(report),
                                      QuestionnaireSection(report)};
  std::ranges::move(EyeSections(report), std::back_inserter(sections));
  sections.push_back(OrderSection(report));
  sections.push_back(DemographicsSection(report));
  sections.push_back(AttentionSection(report));
  sections.push_back(DeviationSection(report));
  for (const TestedMeasure& tested : report.tested) {
    if (tested.plan) sections.push_back(PlanSection(tested));
  }
  sections.push_back({.title = "The paper's own statistics",
                      .remarks = {"./conav audit paper recomputes what the paper prints "
                                  "(docs/paper.md); its people and these are other people."}});
  return sections;
}

}  // namespace conav::study
