#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "study/gaze/participant_eye.h"

/// What people did in `conav study --live`, from the folder of the study:
///
///   forms/<form>.json                the forms that were shown, with "scoring"
///   P07/participant.json             the design: order, parts with method, layout, rotation, seed
///   P07/result.json                  complete, aborted, and each finished step with its folder
///   P07/NN-step/result.json          the result of one step
///   P07/log.jsonl                    one event a line: pauses, deaths of processes, notes
namespace conav::study {

using Json = nlohmann::ordered_json;

/// A form that a participant filled in.
struct LiveForm {
  std::string form;  // its name: nasa-tlx
  std::string step;
  std::string file;     // its result, from the study's folder on; so are all `file`s
  std::string version;  // of the form
  Json answers;         // by question; those of a matrix as "question.row"
  std::optional<bool> attention_passed;  // empty: no attention check in it

  /// A number, or text that is one.
  std::optional<double> Number(const std::string& question) const;
};

/// A maze that counts (no training), and the forms about its method that followed.
struct LiveTrial {
  std::string step;
  std::string file;
  std::string method;
  std::string layout;
  int position = 1;  // among the participant's trials, in the order in which they were done
  Json result;       // of the step, with what the design says of it
  std::vector<LiveForm> forms;
  std::optional<gaze::TrialMeasures> eye;  // empty: nothing was recorded

  std::optional<double> Number(const std::string& key) const;
};

enum class ParticipantState {
  kComplete,    // counts
  kIncomplete,  // not finished; may still go on
  kAborted,
  kMalformed,  // a file cannot be read
  kOther,      // complete, but not named by --participants
};

const char* Name(ParticipantState state);

/// Something that did not go as planned; it excludes nobody.
struct Deviation {
  std::string step;
  std::string text;
  std::string file;
};

struct LiveParticipant {
  std::string name;  // of the folder
  ParticipantState state = ParticipantState::kIncomplete;
  std::string reason;  // why it is not complete
  std::string file;    // that says so
  Json design;         // participant.json
  std::vector<LiveTrial> trials;
  std::vector<LiveForm> forms;  // that belong to no trial: demographics, debriefing
  std::vector<Deviation> deviations;

  bool counts() const { return state == ParticipantState::kComplete; }
};

/// How a questionnaire's score follows from the answers (property "scoring" of the form).
struct ScoreRule {
  enum class Kind {
    kMean,  // of the items, those in `reversed` as max + min - answer
    kSus,  // Brooke, 1996: 2.5 x sum of (answer - 1) of items 1, 3, .. and of (5 - answer) of 2, 4, ..
  };
  std::string name;
  std::string form;
  Kind kind = Kind::kMean;
  std::vector<std::string> items;
  std::vector<std::string> reversed;
  double min = 1.0;  // of an answer, for reversed items
  double max = 7.0;
};

/// Empty: an item has no answer, or one that is impossible.
std::optional<double> Score(const ScoreRule& rule, const LiveForm& form);

struct LiveStudy {
  std::filesystem::path folder;
  std::vector<LiveParticipant> participants;  // by name
  std::map<std::string, Json> forms;          // the definitions
  std::vector<ScoreRule> scores;
  std::vector<std::string> problems;  // malformed files, each with the reason

  std::vector<std::string> Methods() const;  // of the trials that count, as first met
  std::size_t CountOf(ParticipantState state) const;
};

/// Reads a study. `only`: the participants that count; empty = all who are complete. A participant whose
/// files are malformed is listed, not an error. Errors: kNotFound (no such folder, no participant in it,
/// or none called like one of `only`), kMalformed (a form), kIo.
[[nodiscard]] Result<LiveStudy> ReadLiveStudy(const std::filesystem::path& folder,
                                              const std::vector<std::string>& only = {});

/// A number that each trial has or lacks.
struct LiveMeasure {
  enum class Kind { kTask, kScore, kItem, kEye };
  std::string key;  // in CSV, JSON and file names
  std::string title;
  std::string unit;
  std::string range;
  std::string source;   // the file below a participant's folder, and the key in it
  std::string missing;  // when it is empty
  Kind kind = Kind::kTask;
  bool tested = true;  // else it is only in trials.csv
  std::function<std::optional<double>(const LiveTrial&)> value;

  bool is_share() const { return range == "0 to 1"; }
};

/// Those that at least one trial has: of the task, the scores and items of questionnaires, the eyes.
std::vector<LiveMeasure> LiveMeasures(const LiveStudy& study);

/// A column of trials.csv.
struct LiveColumn {
  std::string name;
  std::string meaning;
  std::string unit;
  std::string range;
  std::string source;
  std::string missing;
  std::function<std::string(const LiveParticipant&, const LiveTrial&)> cell;
};

/// In the order of the file; each name once.
std::vector<LiveColumn> LiveColumns(const LiveStudy& study, std::span<const LiveMeasure> measures);

/// A line per trial of every participant whose files could be read, line breaks in answers as blanks.
std::string LiveTrialsCsv(const LiveStudy& study, std::span<const LiveColumn> columns);

/// A line per column: column,meaning,unit,range,source,missing.
std::string CodebookCsv(std::span<const LiveColumn> columns);

/// A question of a form that someone answered.
struct LiveQuestion {
  std::string form;
  std::string name;
  bool is_number = true;  // all answers are

  std::string key() const;  // "form_question" of letters, digits and "_"
};

/// The questions of forms about trials, or of those that belong to participants, as first met.
std::vector<LiveQuestion> QuestionsIn(const LiveStudy& study, bool of_trials);
/// Whether the form says which answer is right.
bool IsAttentionCheck(const LiveStudy& study, const LiveQuestion& question);
/// A question's title in the form's default language; its name if it has none.
std::string QuestionTitle(const LiveStudy& study, const std::string& form,
                          const std::string& question);
/// "1 to 5" of a rating, min and max of a number; empty where the form does not say.
std::string RangeOf(const LiveStudy& study, const std::string& form, const std::string& question);
/// The form of that name; null if there is none.
const LiveForm* FormIn(const std::vector<LiveForm>& forms, const std::string& name);
/// The text of an answer for a table: a list with "; " between, true as yes.
std::string AnswerText(const Json& answer);
/// Text on one line: readers of CSV take files line by line.
std::string OneLine(std::string text);

}  // namespace conav::study
