#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "study/live_results.h"
#include "study/report_page.h"

namespace conav::study {
namespace {

LiveColumn ResultColumn(std::string name, std::string meaning, std::string unit, std::string range,
                        const char* key) {
  return {std::move(name),
          std::move(meaning),
          std::move(unit),
          std::move(range),
          fmt::format("NN-STEP/result.json or participant.json: {}", key),
          "not in the files",
          [key](const LiveParticipant&, const LiveTrial& trial) {
            return trial.result.contains(key) ? AnswerText(trial.result[key]) : std::string();
          }};
}

std::vector<LiveColumn> IdentityColumns() {
  using P = LiveParticipant;
  using T = LiveTrial;
  std::vector<LiveColumn> columns{
      {"participant", "Code of the participant", "", "", "name of the folder", "never",
       [](const P& p, const T&) { return p.name; }},
      {"included", "Whether the participant is in tables and tests", "", "yes, no", "result.json",
       "never", [](const P& p, const T&) { return std::string(p.counts() ? "yes" : "no"); }},
      {"excluded_reason", "Why not", "", "", "result.json", "included",
       [](const P& p, const T&) {
         return p.counts() ? std::string() : fmt::format("{}: {}", Name(p.state), p.reason);
       }},
      {"design_order", "Row of the Williams design", "", "1 or more", "participant.json: order",
       "not in the file",
       [](const P& p, const T&) {
         return p.design.contains("order") ? AnswerText(p.design["order"]) : std::string();
       }},
      {"position", "Place among the participant's trials", "", "1 or more",
       "result.json: order of steps", "never",
       [](const P&, const T& t) { return std::to_string(t.position); }},
      {"step", "Step of the protocol", "", "", "result.json: step", "never",
       [](const P&, const T& t) { return t.step; }},
      {"method", "Method of the planner", "", "", "NN-STEP/result.json: method", "never",
       [](const P&, const T& t) { return t.method; }}};
  columns.push_back(ResultColumn("layout", "Name of the maze", "", "", "layout"));
  columns.push_back(ResultColumn("rotation_deg", "By how much the maze is turned", "degrees",
                                 "0, 90, 180, 270", "rotation"));
  columns.push_back(ResultColumn("maze_seed", "Seed of the maze", "", "", "seed"));
  columns.push_back(ResultColumn("robots", "Robots", "", "1 or more", "robots"));
  columns.push_back(
      ResultColumn("began_at", "When the trial began", "s since 1970, UTC", "", "began_at"));
  columns.push_back(
      ResultColumn("finished_at", "When it was finished", "s since 1970, UTC", "", "finished_at"));
  columns.push_back(
      ResultColumn("timed_out", "Whether its time limit ended it", "", "yes, no", "timed_out"));
  return columns;
}

LiveColumn AttentionColumn() {
  return {"attention_passed",
          "Whether all attention checks in the forms after the method were passed",
          "",
          "yes, no",
          "NN-STEP/result.json of the forms: attention_passed",
          "no attention check",
          [](const LiveParticipant&, const LiveTrial& trial) -> std::string {
            bool any = false;
            bool passed = true;
            for (const LiveForm& form : trial.forms) {
              any = any || form.attention_passed;
              passed = passed && form.attention_passed.value_or(true);
            }
            return any ? (passed ? "yes" : "no") : "";
          }};
}

LiveColumn EyeColumn(const char* name, const char* meaning, bool with_reason) {
  return {name,
          meaning,
          "",
          with_reason ? "" : "yes, no",
          "recordings of the eye tracker",
          with_reason ? "nothing to say" : "no eye tracker",
          [with_reason](const LiveParticipant&, const LiveTrial& trial) -> std::string {
            if (!trial.eye) return "";
            if (with_reason) return OneLine(trial.eye->problem);
            return trial.eye->problem.empty() ? "no" : "yes";
          }};
}

/// An answer about the trial, or one of the participant in each of their rows.
LiveColumn AnswerColumn(const LiveStudy& study, const LiveQuestion& question, bool of_trial) {
  return {question.key(),
          QuestionTitle(study, question.form, question.name),
          "answer",
          RangeOf(study, question.form, question.name),
          fmt::format("NN-STEP/result.json of form {}: answers.{}", question.form, question.name),
          "no answer",
          [question, of_trial](const LiveParticipant& participant, const LiveTrial& trial) {
            const LiveForm* form =
                FormIn(of_trial ? trial.forms : participant.forms, question.form);
            const bool known = form != nullptr && form->answers.contains(question.name);
            return known ? OneLine(AnswerText(form->answers[question.name])) : std::string();
          }};
}

}  // namespace

std::vector<LiveColumn> LiveColumns(const LiveStudy& study, std::span<const LiveMeasure> measures) {
  std::vector<LiveColumn> columns = IdentityColumns();
  for (const LiveMeasure& measure : measures) {
    columns.push_back({measure.key, measure.title, measure.unit, measure.range, measure.source,
                       measure.missing, [measure](const LiveParticipant&, const LiveTrial& trial) {
                         const auto value = measure.value(trial);
                         return value ? fmt::format("{}", *value) : std::string();
                       }});
  }
  for (const LiveQuestion& question : QuestionsIn(study, true)) {
    if (question.is_number && !IsAttentionCheck(study, question)) continue;  // a measure
    columns.push_back(AnswerColumn(study, question, true));
  }
  columns.push_back(AttentionColumn());
  if (std::ranges::any_of(measures, [](const LiveMeasure& measure) {
        return measure.kind == LiveMeasure::Kind::kEye;
      })) {
    columns.push_back(EyeColumn("eye_excluded", "Whether the trial's pupils do not count", false));
    columns.push_back(EyeColumn("eye_excluded_reason", "Why they do not", true));
  }
  for (const LiveQuestion& question : QuestionsIn(study, false)) {
    columns.push_back(AnswerColumn(study, question, false));
  }
  columns.push_back({"file", "Result of the trial, from the study's folder on", "", "", "itself",
                     "never",
                     [](const LiveParticipant&, const LiveTrial& trial) { return trial.file; }});
  std::set<std::string> names;
  for (LiveColumn& column : columns) {
    const std::string name = column.name;
    for (int n = 2; !names.insert(column.name).second; ++n)
      column.name = fmt::format("{}_{}", name, n);
  }
  return columns;
}

std::string LiveTrialsCsv(const LiveStudy& study, std::span<const LiveColumn> columns) {
  std::string csv;
  for (const LiveColumn& column : columns) csv += CsvText(column.name) + ",";
  csv.back() = '\n';
  for (const LiveParticipant& participant : study.participants) {
    for (const LiveTrial& trial : participant.trials) {
      std::string line;
      for (const LiveColumn& column : columns) {
        line += CsvText(column.cell(participant, trial)) + ",";
      }
      line.back() = '\n';
      csv += line;
    }
  }
  return csv;
}

std::string CodebookCsv(std::span<const LiveColumn> columns) {
  std::string csv = "column,meaning,unit,range,source,missing\n";
  for (const LiveColumn& column : columns) {
    csv += fmt::format("{},{},{},{},{},{}\n", CsvText(column.name),
                       CsvText(OneLine(column.meaning)), CsvText(column.unit),
                       CsvText(column.range), CsvText(column.source), CsvText(column.missing));
  }
  return csv;
}

}  // namespace conav::study
