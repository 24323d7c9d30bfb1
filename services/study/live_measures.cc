#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <set>

#include "study/live_results.h"
#include "study/report_page.h"

namespace conav::study {
namespace {

constexpr const char* kUnmeasured = "not in the step's result";

/// A number of the result of a maze.
struct TaskMeasure {
  const char* key;
  const char* title;
  const char* unit;
  const char* range;
  bool tested;
};

constexpr TaskMeasure kTaskMeasures[] = {
    {"low_level_steps", "Low-level steps of 0.25 s, all robots", "steps", "0 or more", true},
    {"cell_moves", "Moves from cell to cell, all robots", "moves", "0 or more", true},
    {"pictures", "Pictures sent, frames of streams included", "pictures", "0 or more", true},
    {"image_bytes", "Bytes of pictures really sent", "bytes", "0 or more", true},
    {"guidance", "Paths from the participant", "paths", "0 or more", true},
    {"mapping_accuracy", "Mapping accuracy: corrected minus broken share of the map's errors", "",
     "0 to 1", true},
    {"cell_accuracy", "Share of the map's cells that are right at the end", "", "0 to 1", true},
    {"initial_cell_accuracy", "The same at first", "", "0 to 1", false},
    {"wrong_at_first", "Wrong cells at first", "cells", "0 or more", false},
    {"corrected", "Of these, right at the end", "cells", "0 or more", false},
    {"broken", "Cells right at first and wrong at the end", "cells", "0 or more", false},
    {"edits", "Edits of the map, a stroke is one", "edits", "0 or more", true},
    {"duration_s", "Wall time from Begin to Finish without pauses", "s", "0 or more", true},
    {"paused_s", "Pauses", "s", "0 or more", false},
    {"pauses", "Number of pauses", "", "0 or more", false},
    {"goals_reached", "Goals reached, all robots", "goals", "0 or more", false},
    {"goals_total", "Goals, all robots", "goals", "0 or more", false},
};

struct EyeMeasure {
  const char* key;
  const char* title;
  const char* unit;
  const char* range;
  std::optional<double> gaze::TrialMeasures::*value;
  bool of_pupils;  // left out where the trial's pupils do not count
  bool tested;
};

constexpr EyeMeasure kEyeMeasures[] = {
    {"pcpd_mean", "PCPD: change of the pupil against its baseline", "%", "-100 or more",
     &gaze::TrialMeasures::pcpd_mean, true, true},
    {"pcpd_sd", "SD of PCPD over the trial", "%", "0 or more", &gaze::TrialMeasures::pcpd_sd, true,
     false},
    {"pupil_diameter", "Pupil diameter", "mm or px", "above 0", &gaze::TrialMeasures::diameter_mean,
     true, true},
    {"pupil_baseline", "Pupil diameter in the baseline before", "mm or px", "above 0",
     &gaze::TrialMeasures::baseline, true, false},
    {"blinks_per_min", "Blinks", "per min", "0 or more", &gaze::TrialMeasures::blinks_per_min,
     false, true},
    {"shifts_per_min", "Fixation shifts between areas", "per min", "0 or more",
     &gaze::TrialMeasures::shifts_per_min, false, true},
};

/// Letters, digits and "_" alone, as programs for statistics take them.
std::string ColumnName(const std::string& text) {
  std::string name;
  for (const char c : text) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0;
    name += plain ? c : '_';
  }
  return name;
}

/// Looks for the question anywhere in the form: on pages, in panels.
const Json* FindQuestion(const Json& element, const std::string& name) {
  if (element.is_object() && element.contains("name") && element["name"] == name &&
      (element.contains("type") || element.contains("title"))) {
    return &element;
  }
  if (!element.is_structured()) return nullptr;
  for (const auto& child : element) {
    if (const Json* found = FindQuestion(child, name)) return found;
  }
  return nullptr;
}

const Json* QuestionOf(const LiveStudy& study, const std::string& form,
                       const std::string& question) {
  const auto found = study.forms.find(form);
  return found == study.forms.end()
             ? nullptr
             : FindQuestion(found->second, question.substr(0, question.find('.')));
}

/// SurveyJS: a text, or one for each language.
std::string Localised(const Json& title) {
  if (title.is_string()) return title.get<std::string>();
  if (!title.is_object() || title.empty()) return {};
  for (const char* language : {"default", "en"}) {
    if (title.contains(language) && title[language].is_string()) {
      return title[language].get<std::string>();
    }
  }
  return title.begin()->is_string() ? title.begin()->get<std::string>() : std::string();
}

std::vector<LiveMeasure> TaskMeasures() {
  std::vector<LiveMeasure> measures;
  for (const TaskMeasure& task : kTaskMeasures) {
    measures.push_back(
        {.key = task.key,
         .title = task.title,
         .unit = task.unit,
         .range = task.range,
         .source = fmt::format("NN-STEP/result.json: {}", task.key),
         .missing = kUnmeasured,
         .tested = task.tested,
         .value = [key = task.key](const LiveTrial& trial) { return trial.Number(key); }});
  }
  measures.push_back({.key = "image_mib",
                      .title = "Communication, 180 KiB a picture as in the paper",
                      .unit = "MiB",
                      .range = "0 or more",
                      .source = "NN-STEP/result.json: pictures",
                      .missing = kUnmeasured,
                      .tested = false,  // pictures in another unit
                      .value = [](const LiveTrial& trial) -> std::optional<double> {
                        const auto pictures = trial.Number("pictures");
                        if (!pictures) return std::nullopt;
                        return *pictures * kPaperImageKib / 1024.0;
                      }});
  measures.push_back({.key = "goals_reached_fraction",
                      .title = "Share of the goals reached",
                      .range = "0 to 1",
                      .source = "NN-STEP/result.json: goals_reached / goals_total",
                      .missing = "not in the step's result, or no goals",
                      .value = [](const LiveTrial& trial) -> std::optional<double> {
                        const auto reached = trial.Number("goals_reached");
                        const auto total = trial.Number("goals_total");
                        if (!reached || !total || *total <= 0.0) return std::nullopt;
                        return *reached / *total;
                      }});
  return measures;
}

void AddScores(const LiveStudy& study, std::vector<LiveMeasure>& measures) {
  std::set<std::string> names;
  for (const LiveMeasure& measure : measures) names.insert(measure.key);
  for (const ScoreRule& rule : study.scores) {
    const bool is_sus = rule.kind == ScoreRule::Kind::kSus;
    std::string key = ColumnName(rule.name);
    if (!names.insert(key).second) key = ColumnName(rule.form + "_" + rule.name);
    std::string title = fmt::format("Score {}: mean of {} answers", rule.name, rule.items.size());
    if (!rule.reversed.empty()) title += fmt::format(", {} reversed", rule.reversed.size());
    if (is_sus) title = fmt::format("Score {}: System Usability Scale", rule.name);
    measures.push_back({.key = key,
                        .title = title,
                        .unit = "points",
                        .range = is_sus ? "0 to 100" : RangeOf(study, rule.form, rule.items[0]),
                        .source = fmt::format("NN-STEP/result.json of form {}: answers", rule.form),
                        .missing = "no such form after the method, or an item without an answer",
                        .kind = LiveMeasure::Kind::kScore,
                        .value = [rule](const LiveTrial& trial) -> std::optional<double> {
                          const LiveForm* form = FormIn(trial.forms, rule.form);
                          return form == nullptr ? std::nullopt : Score(rule, *form);
                        }});
  }
}

void AddItems(const LiveStudy& study, std::vector<LiveMeasure>& measures) {
  for (const LiveQuestion& question : QuestionsIn(study, true)) {
    if (!question.is_number || IsAttentionCheck(study, question)) continue;
    measures.push_back({.key = question.key(),
                        .title = QuestionTitle(study, question.form, question.name),
                        .unit = "answer",
                        .range = RangeOf(study, question.form, question.name),
                        .source = fmt::format("NN-STEP/result.json of form {}: answers.{}",
                                              question.form, question.name),
                        .missing = "no answer",
                        .kind = LiveMeasure::Kind::kItem,
                        .tested = false,
                        .value = [question](const LiveTrial& trial) -> std::optional<double> {
                          const LiveForm* form = FormIn(trial.forms, question.form);
                          return form == nullptr ? std::nullopt : form->Number(question.name);
                        }});
  }
}

std::set<std::string> AreasIn(const LiveStudy& study) {
  std::set<std::string> areas;
  for (const LiveParticipant& participant : study.participants) {
    for (const LiveTrial& trial : participant.trials) {
      if (!trial.eye) continue;
      for (const auto& [area, rate] : trial.eye->fixations_per_min) areas.insert(area);
    }
  }
  return areas;
}

using AreaValues = std::map<std::string, double> gaze::TrialMeasures::*;

LiveMeasure AreaMeasure(const char* key, const char* title, const char* unit, const char* range,
                        const std::string& area, AreaValues values) {
  return {.key = fmt::format("{}_{}", key, ColumnName(area)),
          .title = fmt::format("{} {}", title, area),
          .unit = unit,
          .range = range,
          .source = "recordings of the eye tracker",
          .missing = "no eye tracker, or no such area",
          .kind = LiveMeasure::Kind::kEye,
          .tested = false,
          .value = [area, values](const LiveTrial& trial) -> std::optional<double> {
            if (!trial.eye) return std::nullopt;
            const auto& found = (*trial.eye).*values;
            const auto at = found.find(area);
            return at == found.end() ? std::nullopt : std::optional(at->second);
          }};
}

void AddEyes(const LiveStudy& study, std::vector<LiveMeasure>& measures) {
  for (const EyeMeasure& eye : kEyeMeasures) {
    measures.push_back({.key = eye.key,
                        .title = eye.title,
                        .unit = eye.unit,
                        .range = eye.range,
                        .source = "recordings of the eye tracker",
                        .missing = eye.of_pupils
                                       ? "no eye tracker, or the trial's pupils do not count"
                                       : "no eye tracker",
                        .kind = LiveMeasure::Kind::kEye,
                        .tested = eye.tested,
                        .value = [eye](const LiveTrial& trial) -> std::optional<double> {
                          if (!trial.eye) return std::nullopt;
                          if (eye.of_pupils && !trial.eye->problem.empty()) return std::nullopt;
                          return (*trial.eye).*eye.value;
                        }});
  }
  measures.push_back({.key = "valid_share",
                      .title = "Share of the trial with a valid pupil diameter",
                      .range = "0 to 1",
                      .source = "recordings of the eye tracker",
                      .missing = "no eye tracker",
                      .kind = LiveMeasure::Kind::kEye,
                      .tested = false,
                      .value = [](const LiveTrial& trial) -> std::optional<double> {
                        if (!trial.eye) return std::nullopt;
                        return trial.eye->valid_share;
                      }});
  for (const std::string& area : AreasIn(study)) {
    measures.push_back(AreaMeasure("fixations_per_min", "Fixations on", "per min", "0 or more",
                                   area, &gaze::TrialMeasures::fixations_per_min));
    measures.push_back(AreaMeasure("dwell_share", "Share of the trial in fixations on", "",
                                   "0 to 1", area, &gaze::TrialMeasures::dwell_share));
  }
}

bool HasValue(const LiveStudy& study, const LiveMeasure& measure) {
  return std::ranges::any_of(study.participants, [&](const LiveParticipant& participant) {
    return std::ranges::any_of(participant.trials, [&](const LiveTrial& trial) {
      return measure.value(trial).has_value();
    });
  });
}

}  // namespace

std::string OneLine(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

std::string RangeOf(const LiveStudy& study, const std::string& form, const std::string& question) {
  const Json* json = QuestionOf(study, form, question);
  if (json == nullptr) return {};
  for (const auto& [low, high] : {std::pair{"rateMin", "rateMax"}, std::pair{"min", "max"}}) {
    if (json->contains(low) && json->contains(high)) {
      return fmt::format("{} to {}", AnswerText((*json)[low]), AnswerText((*json)[high]));
    }
  }
  return {};
}

std::string LiveQuestion::key() const { return ColumnName(form) + "_" + ColumnName(name); }

std::vector<LiveQuestion> QuestionsIn(const LiveStudy& study, bool of_trials) {
  std::vector<LiveQuestion> questions;
  const auto add = [&](const LiveForm& form) {
    for (const auto& [name, answer] : form.answers.items()) {
      auto known = std::ranges::find_if(questions, [&, &name = name](const LiveQuestion& question) {
        return question.form == form.form && question.name == name;
      });
      if (known == questions.end()) known = questions.insert(known, {form.form, name});
      const bool is_empty = answer.is_null();
      known->is_number = known->is_number && (is_empty || form.Number(name).has_value());
    }
  };
  for (const LiveParticipant& participant : study.participants) {
    if (!of_trials) std::ranges::for_each(participant.forms, add);
    for (const LiveTrial& trial : participant.trials) {
      if (of_trials) std::ranges::for_each(trial.forms, add);
    }
  }
  return questions;
}

const LiveForm* FormIn(const std::vector<LiveForm>& forms, const std::string& name) {
  const auto found = std::ranges::find(forms, name, &LiveForm::form);
  return found == forms.end() ? nullptr : &*found;
}

bool IsAttentionCheck(const LiveStudy& study, const LiveQuestion& question) {
  const Json* json = QuestionOf(study, question.form, question.name);
  return json != nullptr && json->contains("attention");
}

std::string AnswerText(const Json& answer) {
  if (answer.is_null()) return {};
  if (answer.is_boolean()) return answer.get<bool>() ? "yes" : "no";
  if (answer.is_string()) return answer.get<std::string>();
  if (!answer.is_array()) return answer.dump();
  std::string text;
  for (const Json& part : answer) {
    text += fmt::format("{}{}", text.empty() ? "" : "; ", AnswerText(part));
  }
  return text;
}

std::string QuestionTitle(const LiveStudy& study, const std::string& form,
                          const std::string& question) {
  const Json* json = QuestionOf(study, form, question);
  std::string title = json != nullptr && json->contains("title") ? Localised((*json)["title"]) : "";
  const std::size_t point = question.find('.');
  if (title.empty()) return question;
  return OneLine(point == std::string::npos ? title : title + ": " + question.substr(point + 1));
}

std::vector<LiveMeasure> LiveMeasures(const LiveStudy& study) {
  std::vector<LiveMeasure> measures = TaskMeasures();
  AddScores(study, measures);
  AddItems(study, measures);
  AddEyes(study, measures);
  std::erase_if(measures, [&](const LiveMeasure& measure) { return !HasValue(study, measure); });
  return measures;
}

}  // namespace conav::study
