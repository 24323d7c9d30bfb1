#include "operator/console/participant_task.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "common/runtime/file.h"
#include "console.pb.h"

namespace conav::operators {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kLongestAnswers = 256 * 1024;
constexpr int kDeepestAnswers = 32;

template <class A, class B>
bool SameShape(const Grid<A>& a, const Grid<B>& b) {
  return a.rows() == b.rows() && a.columns() == b.columns();
}

bool WorksOnTheMap(const OperatorRequest& request) {
  return std::holds_alternative<EditRequest>(request.body) ||
         std::holds_alternative<AnswerRequest>(request.body);
}

bool CommandsARobot(const OperatorRequest& request) {
  return std::holds_alternative<GuideRequest>(request.body) ||
         std::holds_alternative<DriveRequest>(request.body);
}

/// A pause is no reason to refuse it.
bool IsAboutSafety(const OperatorRequest& request) {
  return std::holds_alternative<StopRequest>(request.body) ||
         std::holds_alternative<NoteRequest>(request.body);
}

/// Of `element`, which holds questions under any of its keys: pages, panels, matrices.
void FindAttention(const Json& element, std::map<std::string, std::string>& found) {
  if (element.is_object() && element.contains("attention") && element.contains("name") &&
      element["name"].is_string()) {
    found[element["name"].get<std::string>()] = element["attention"].dump();
  }
  if (!element.is_structured()) return;
  for (const Json& inner : element) FindAttention(inner, found);
}

}  // namespace

TaskKind KindOf(const TaskOptions& options) {
  if (options.kind == "study") return TaskKind::kStudy;
  if (options.kind == "form") return TaskKind::kForm;
  return options.kind == "rest" ? TaskKind::kRest : TaskKind::kMapping;
}

console::Task ToConsole(const TaskOptions& options, const TaskStatus& status) {
  const bool is_finished = status.phase == TaskPhase::kFinished;
  console::Task message;
  message.set_participant(options.participant);
  message.set_number(static_cast<std::uint32_t>(options.number));
  message.set_count(static_cast<std::uint32_t>(options.count));
  message.set_phase(static_cast<console::TaskPhase>(status.phase));
  message.set_goals_left(status.goals_left);
  message.set_may_finish(status.may_finish);
  message.set_show_scores(options.show_scores);
  if (options.show_scores) {
    message.set_mapping_accuracy(status.mapping_accuracy);
    message.mutable_earlier()->Add(options.earlier.begin(), options.earlier.end());
  }
  message.set_kind(static_cast<console::TaskKind>(KindOf(options)));
  message.set_step(options.step);
  message.set_title(options.title);
  message.set_introduction(options.introduction);
  message.set_language(options.language);
  message.set_feedback(options.feedback);
  message.set_time_limit(options.limit_s());
  message.set_used(status.used_s);
  message.set_since(status.since_s);
  message.set_paused(status.paused);
  message.set_aborted(status.aborted);
  if (is_finished) message.set_completion_code(options.completion_code);
  return message;
}

std::optional<StudyRequest> ToStudyRequest(const console::Request& request,
                                           const std::string& client) {
  using Kind = StudyRequest::Kind;
  const auto of = [&](Kind kind, std::string text, std::string step = "") {
    return StudyRequest{kind, std::move(text), std::move(step), client, request.id()};
  };
  if (request.has_begin()) return of(Kind::kBegin, "");
  if (request.has_answers()) {
    return of(Kind::kAnswers, request.answers().json(), request.answers().step());
  }
  if (request.has_draft()) {
    return of(Kind::kDraft, request.draft().json(), request.draft().step());
  }
  if (request.has_abort()) return of(Kind::kAbort, request.abort().reason());
  if (!request.has_pause()) return std::nullopt;
  return of(request.pause().on() ? Kind::kPause : Kind::kContinue, "");
}

std::string ToText(const StepProgress& progress) {
  Json json = {{"began_at", progress.began_at_s}, {"saved_at", progress.saved_at_s},
               {"used_s", progress.used_s},       {"paused_s", progress.paused_s},
               {"pauses", progress.pauses},       {"paused", progress.paused},
               {"resume", progress.resume},       {"guidance", progress.guidance},
               {"answers", progress.answers}};
  Json log = Json::array();
  for (const auto& [at_s, event, text] : progress.log) log.push_back({at_s, event, text});
  json["log"] = std::move(log);
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Result<StepProgress> ParseStepProgress(const std::string& text) {
  StepProgress progress;
  try {
    const Json json = Json::parse(text);
    json.at("began_at").get_to(progress.began_at_s);
    json.at("saved_at").get_to(progress.saved_at_s);
    json.at("used_s").get_to(progress.used_s);
    json.at("paused_s").get_to(progress.paused_s);
    json.at("pauses").get_to(progress.pauses);
    json.at("paused").get_to(progress.paused);
    json.at("resume").get_to(progress.resume);
    json.at("guidance").get_to(progress.guidance);
    json.at("answers").get_to(progress.answers);
    for (const Json& entry : json.at("log")) {
      progress.log.push_back({entry.at(0).get<double>(), entry.at(1).get<std::string>(),
                              entry.at(2).get<std::string>()});
    }
  } catch (const Json::exception& error) {
    return Fail(ErrorCode::kMalformed, error.what());
  }
  return progress;
}

Result<StudyForm> ReadStudyForm(const std::filesystem::path& file) {
  return ReadFile(file).and_then([&](const std::string& text) -> Result<StudyForm> {
    const Json json = Json::parse(text, nullptr, false);
    if (!json.is_object()) {
      return Fail(ErrorCode::kMalformed, file.string() + " is not a form in JSON");
    }
    StudyForm form{file.stem().string(), json.dump(), "", {}};
    if (json.contains("version")) form.version = json["version"].dump();
    FindAttention(json, form.attention);
    return form;
  });
}

Result<PageWords> ParsePageWords(const std::string& json) {
  const Json all = Json::parse(json, nullptr, false);
  if (!all.is_object()) return Fail(ErrorCode::kMalformed, "is no JSON object of texts");
  PageWords words;
  for (const auto& [english, word] : all.items()) {
    if (!word.is_string() || english.empty()) {
      return Fail(ErrorCode::kMalformed, fmt::format("'{}': is no text", english));
    }
    const std::string text = word.get<std::string>();
    const auto gaps = [](std::string_view in) {
      std::size_t count = 0;
      for (auto at = in.find("{}"); at != in.npos; at = in.find("{}", at + 2)) ++count;
      return count;
    };
    if (gaps(english) != gaps(text)) {
      return Fail(ErrorCode::kMalformed, fmt::format("'{}': has {} gaps {{}}, '{}' has {}", english,
                                                     gaps(english), text, gaps(text)));
    }
    words[english] = text;
  }
  return words;
}

Result<std::string> CheckedAnswers(const std::string& json) {
  if (json.size() > kLongestAnswers) {
    return Fail(ErrorCode::kMalformed, fmt::format("answers of {} bytes are longer than {}",
                                                   json.size(), kLongestAnswers));
  }
  bool is_deep = false;
  const auto check = [&](int depth, Json::parse_event_t, Json&) {
    is_deep = is_deep || depth > kDeepestAnswers;
    return depth <= kDeepestAnswers;
  };
  const Json answers = Json::parse(json, check, false);
  if (is_deep || !answers.is_object()) {
    return Fail(ErrorCode::kMalformed, "the answers are no JSON object, or nested too deeply");
  }
  return answers.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::optional<bool> AttentionPassed(const StudyForm& form, const std::string& answers) {
  if (form.attention.empty()) return std::nullopt;
  const Json given = Json::parse(answers, nullptr, false);
  return std::ranges::all_of(form.attention, [&](const auto& check) {
    return given.contains(check.first) && given[check.first].dump() == check.second;
  });
}

void ParticipantTask::Receive(const RobotState& state) {
  if (!robots_.contains(state.robot)) return;
  reported_[state.robot] = {state.snapshots,
                            state.image_bytes,
                            state.low_level_steps,
                            state.cell_moves,
                            static_cast<std::uint32_t>(state.goals_left.size()),
                            static_cast<std::uint32_t>(state.goals_reached.size()),
                            state.goals_total};
}

void ParticipantTask::Begin() {
  if (phase_ == TaskPhase::kWaiting) phase_ = TaskPhase::kRunning;
}

RobotSums ParticipantTask::sums() const {
  RobotSums all;
  for (const auto& [name, robot] : reported_) {
    all.images += robot.images;
    all.image_bytes += robot.image_bytes;
    all.low_level_steps += robot.low_level_steps;
    all.cell_moves += robot.cell_moves;
    all.goals_left += robot.goals_left;
    all.goals_reached += robot.goals_reached;
    all.goals_total += robot.goals_total;
  }
  return all;
}

std::string ParticipantTask::CheckAllowed(const OperatorRequest& request) const {
  const bool commands = CommandsARobot(request);
  if (commands && kind_ == TaskKind::kMapping) {
    return "in the mapping task the robot finds its own way: answer its picture instead";
  }
  const bool is_over = phase_ == TaskPhase::kFinished;
  if (is_over && (commands || WorksOnTheMap(request))) return "this maze is finished";
  return paused_ && !IsAboutSafety(request) ? "this step is paused" : "";
}

std::string ParticipantTask::CheckFinish() const {
  if (!is_maze()) return "this step has no maze";
  if (phase_ == TaskPhase::kFinished) return "this maze is finished";
  if (phase_ == TaskPhase::kWaiting) return "this maze has not begun yet: resume the robot first";
  if (reported_.size() < robots_.size()) return "the robot has not reported yet";
  if (const std::uint32_t left = sums().goals_left; left > 0) {
    return fmt::format("the robot has {} more {} to reach", left, left == 1 ? "goal" : "goals");
  }
  return truth_ ? "" : "the true maze is not known yet: try again in a moment";
}

Result<TaskResult> ParticipantTask::Measure(const Belief& belief, const BeliefGrid& initial) const {
  if (!truth_) return Fail(ErrorCode::kRefused, "the true maze is not known yet");
  if (!SameShape(*truth_, belief.wall_probability) || !SameShape(*truth_, initial)) {
    return Fail(ErrorCode::kRefused, "the true maze has another size than the map");
  }
  const OccupancyGrid before = ToOccupancy(initial);
  const MapAccuracy now = CompareMaps(*truth_, before, belief.wall_probability);
  TaskResult result;
  result.mapping_accuracy = now.mapping;
  result.cell_accuracy = now.cell;
  result.initial_cell_accuracy = CompareMaps(*truth_, before, initial).cell;
  result.wrong_at_first = now.wrong_at_first;
  result.corrected = now.corrected;
  result.broken = now.broken;
  result.edits = belief.revision;
  return result;
}

}  // namespace conav::operators
