#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/grid/map_accuracy.h"
#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/config.h"
#include "common/runtime/result.h"
#include "common/runtime/text.h"

namespace conav::console {
class Request;
class Task;
}  // namespace conav::console

namespace conav::operators {

/// Section `operator.task:`, for those who let people take part in something
/// (docs/mapping-task.md). All robots are then in one world; forms and rests need none.
struct TaskOptions {
  /// "mapping" = one maze of the mapping task; "study" = one maze with the method of the planners;
  /// "form" = questions and texts; "rest" = a calm screen for a time; empty = none, robots are
  /// supervised.
  std::string kind;
  /// Which step of a protocol this is: 1 to 64 of A-Z a-z 0-9 -; empty = none.
  std::string step;
  std::string participant;  // a pseudonym, UTF-8 without slashes and control characters
  int number = 1;           // which of the mazes or steps, for the page
  int count = 1;            // of mazes or steps
  std::string title;        // for the participant; empty = one made of number and count
  /// Mapping accuracies of the mazes before, 0 to 1, for the page.
  std::vector<double> earlier;
  /// JSON file that the result is written to when the step is finished; with one of a step that was
  /// finished before, the service takes it as finished. What a restart needs of a step that is under
  /// way stands in "<result>.draft".
  std::string result;
  std::string form;     // form: a SurveyJS JSON file
  double rest_s = 0.0;  // rest: how long
  /// Before "Begin", plain text, paragraphs by empty lines; empty = that of the method.
  std::string introduction;
  std::string language = "en";
  std::string words;        // JSON file: the page's texts in it (ParsePageWords); empty = English
  bool show_scores = true;  // the accuracy of this maze, once it is finished, and of those before
  bool feedback = true;     // goals left and the like, during a maze
  /// A maze ends by itself after so long without pauses (wall time); 0 = it does not.
  double time_limit_s = 0.0;
  bool training = false;        // the maze counts as training
  std::string layout;           // of the maze, for result and marks
  int rotation = 0;             // likewise, degrees
  bool experimenter = false;    // pages may ask for the experimenter's role
  bool tags = false;            // AprilTags at the edges of the participant's page (docs/gaze.md)
  std::string completion_code;  // form: shown when it is finished

  bool on() const { return !kind.empty(); }
  /// Whether there are robots.
  bool is_maze() const { return kind == "mapping" || kind == "study"; }
  /// After which the step ends by itself; 0 = it does not.
  double limit_s() const { return kind == "rest" ? rest_s : is_maze() ? time_limit_s : 0.0; }
  void Visit(ConfigReader& reader) {
    reader.Choice("kind", kind, {"", "mapping", "study", "form", "rest"});
    reader.Field("step", step);
    if (!IsStep(step)) reader.Refuse("step", "is not up to 64 of A-Z a-z 0-9 -");
    reader.Field("participant", participant);
    if (!IsPlainName(participant)) reader.Refuse("participant", kNoPlainName);
    reader.Field("number", number, 1, 1000);
    reader.Field("count", count, 1, 1000);
    if (number > count) reader.Refuse("number", "is above count");
    reader.Field("title", title);
    reader.Field("earlier", earlier);
    const auto is_share = [](double accuracy) { return accuracy >= 0.0 && accuracy <= 1.0; };
    if (!std::ranges::all_of(earlier, is_share)) {
      reader.Refuse("earlier", "has a value that is out of range [0, 1]");
    }
    reader.Field("result", result);
    if (on() && result.empty()) reader.Refuse("result", "names no file");
    reader.Field("form", form);
    if (kind == "form" && form.empty()) reader.Refuse("form", "names no file");
    reader.Field("rest_s", rest_s, 0.0, 86400.0);
    if (kind == "rest" && rest_s == 0.0) reader.Refuse("rest_s", "is 0");
    reader.Field("introduction", introduction);
    reader.Field("language", language);
    reader.Field("words", words);
    reader.Field("show_scores", show_scores);
    reader.Field("feedback", feedback);
    reader.Field("time_limit_s", time_limit_s, 0.0, 86400.0);
    reader.Field("training", training);
    reader.Field("layout", layout);
    reader.Field("rotation", rotation, 0, 359);
    reader.Field("experimenter", experimenter);
    reader.Field("tags", tags);
    reader.Field("completion_code", completion_code);
  }

 private:
  static bool IsStep(std::string_view step) {
    return step.size() <= kMaxName && std::ranges::all_of(step, [](char c) {
             return c == '-' || (c != '_' && IsNameCharacter(c));
           });
  }
};

/// In the order of console::TaskKind.
enum class TaskKind {
  kMapping,  // the robot finds its own way
  kStudy,    // the participant guides or drives it, as the method says
  kForm,
  kRest,
};

/// Of a TaskOptions::kind that is not empty.
TaskKind KindOf(const TaskOptions& options);

enum class TaskPhase {
  kWaiting,  // for the participant to begin; robots are stopped until then
  kRunning,
  kFinished,  // the map stays as it is
};

/// What a page shows. What is the same all the time stands in TaskOptions.
struct TaskStatus {
  TaskPhase phase = TaskPhase::kWaiting;
  std::uint32_t goals_left = 0;
  bool may_finish = false;
  double mapping_accuracy = 0.0;  // once it is finished
  double used_s = 0.0;            // of the step's time, at `since_s`
  double since_s = 0.0;           // wall time since when its clock runs; 0 = it stands
  bool paused = false;
  bool aborted = false;
  bool operator==(const TaskStatus&) const = default;
};

console::Task ToConsole(const TaskOptions& options, const TaskStatus& status);

/// How the participant did.
struct TaskResult {
  double mapping_accuracy = 0.0;
  double cell_accuracy = 0.0;
  double initial_cell_accuracy = 0.0;
  int wrong_at_first = 0;   // cells of the map
  int corrected = 0;        // of these
  int broken = 0;           // cells that were right at first
  std::uint64_t edits = 0;  // requests that changed the map
  bool operator==(const TaskResult&) const = default;
};

/// What robots did, summed over those of a maze; from their states.
struct RobotSums {
  std::uint64_t images = 0;  // snapshots
  std::uint64_t image_bytes = 0;
  std::uint64_t low_level_steps = 0;
  std::uint64_t cell_moves = 0;
  std::uint32_t goals_left = 0;
  std::uint32_t goals_reached = 0;
  std::uint32_t goals_total = 0;
};

/// A page's request that is about the step itself. Sent again, each does no more than the first time.
struct StudyRequest {
  enum class Kind { kBegin, kAnswers, kDraft, kPause, kContinue, kAbort };
  Kind kind = Kind::kBegin;
  std::string text;  // answers, draft: JSON; abort: the reason
  std::string step;  // answers, draft: of which; empty = whichever it is
  std::string client;
  std::uint64_t id = 0;
};

/// Nothing for a request that is none.
std::optional<StudyRequest> ToStudyRequest(const console::Request& request,
                                           const std::string& client);

/// A moment of a step. `event` as console::StudyEntry.
struct StepEntry {
  double at_s = 0.0;  // wall time, s since 1970
  std::string event;
  std::string text;
  bool operator==(const StepEntry&) const = default;
};

/// What of a step that is under way outlives the service.
struct StepProgress {
  double began_at_s = 0.0;  // wall time, s since 1970; 0 = not yet
  double saved_at_s = 0.0;  // likewise
  double used_s = 0.0;      // since then, without pauses and the service's downtime
  double paused_s = 0.0;
  int pauses = 0;
  bool paused = false;
  std::set<std::string> resume;  // robots that drove before the pause
  std::uint64_t guidance = 0;    // paths that were accepted
  std::string answers;           // of a half-filled form, a JSON object; empty = none
  std::vector<StepEntry> log;    // oldest first
  bool operator==(const StepProgress&) const = default;
};

std::string ToText(const StepProgress& progress);
/// Errors: kMalformed.
[[nodiscard]] Result<StepProgress> ParseStepProgress(const std::string& text);

/// A SurveyJS form and what conav adds to it: properties `version` of the form, `attention` of a
/// question (the value that an attentive person gives).
struct StudyForm {
  std::string name;  // of its file
  std::string json;
  std::string version;                           // JSON text; empty = none
  std::map<std::string, std::string> attention;  // JSON text of the value, by question
};

/// Errors: those of ReadFile; kMalformed names the file.
[[nodiscard]] Result<StudyForm> ReadStudyForm(const std::filesystem::path& file);

/// The texts of a participant's page in another language, by the English ones: a JSON object.
using PageWords = std::map<std::string, std::string>;
/// Errors: kMalformed without the file's name.
[[nodiscard]] Result<PageWords> ParsePageWords(const std::string& json);

/// A JSON object as it came from a page, without blanks. Errors: kMalformed: no object, nested too
/// deeply, too long.
[[nodiscard]] Result<std::string> CheckedAnswers(const std::string& json);

/// Whether all attention checks of `form` were passed; nothing without one. `answers`: checked.
std::optional<bool> AttentionPassed(const StudyForm& form, const std::string& answers);

/// One step as the participant goes through it: a maze of the mapping task (paper, Appendix A) or of
/// a study, a form or a rest. A maze begins when a robot is resumed, may be finished as soon as the
/// robots have reached all goals, and then the map stays as it is. Pure; threads: not synchronised.
class ParticipantTask {
 public:
  /// `robots`: those of the maze.
  explicit ParticipantTask(std::set<std::string> robots, TaskKind kind = TaskKind::kMapping)
      : robots_(std::move(robots)), kind_(kind) {}

  void Receive(const RobotState& state);
  /// The true maze.
  void Receive(const OccupancyGrid& truth) { truth_ = truth; }
  /// A robot was resumed; ignored after the first time.
  void Begin();
  void SetPaused(bool paused) { paused_ = paused; }

  TaskPhase phase() const { return phase_; }
  bool is_maze() const { return kind_ == TaskKind::kMapping || kind_ == TaskKind::kStudy; }
  RobotSums sums() const;

  /// Why the task forbids `request`; empty = it does not.
  std::string CheckAllowed(const OperatorRequest& request) const;
  /// Why the participant may not finish; empty = they may.
  std::string CheckFinish() const;
  /// What it would be with the map as it is now, which was `initial` at first. Errors: kRefused when
  /// the true maze is not known, or the maps do not belong together.
  [[nodiscard]] Result<TaskResult> Measure(const Belief& belief, const BeliefGrid& initial) const;
  void Finish() { phase_ = TaskPhase::kFinished; }

 private:
  std::set<std::string> robots_;
  TaskKind kind_;
  std::map<std::string, RobotSums> reported_;
  std::optional<OccupancyGrid> truth_;
  TaskPhase phase_ = TaskPhase::kWaiting;
  bool paused_ = false;
};

}  // namespace conav::operators
