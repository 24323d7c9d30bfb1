#include "operator/console/task_topics.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/msg/convert.h"
#include "common/runtime/file.h"
#include "common/runtime/log.h"
#include "common/runtime/text.h"

namespace conav::operators {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kResultKey = "operator.task.result: ";
constexpr std::chrono::seconds kRetry{1};
constexpr std::size_t kLongestReason = 1000;  // bytes
constexpr std::size_t kMostEntries = 1000;    // of a step's log

template <class T>
T OrStop(Result<T> result, const std::string& what) {
  if (!result) throw StartupError(what + result.error().text);
  return *std::move(result);
}

std::string OnlyWorld(const OperatorConfig& config) {
  const auto world_of_robot = config.world_of_robot();
  if (world_of_robot.empty()) return "";
  const std::string& first = world_of_robot.begin()->second;
  for (const auto& [robot, world] : world_of_robot) {
    if (world == first) continue;
    throw StartupError(fmt::format(
        "operator.task: all robots have to be in one world, not in {} and {}", first, world));
  }
  return first;
}

std::set<std::string> Robots(const OperatorConfig& config) {
  std::set<std::string> robots;
  for (const auto& [robot, world] : config.world_of_robot()) robots.insert(robot);
  return robots;
}

/// Nothing where there is no such file, or a power cut left an empty one.
std::optional<std::string> ReadIfThere(const std::string& file) {
  auto text = ReadFile(file);
  if (!text && text.error().code == ErrorCode::kNotFound) return std::nullopt;
  if (text && text->empty()) return std::nullopt;
  return OrStop(std::move(text), kResultKey);
}

/// How marks name the step.
std::string MarkName(const TaskOptions& options) {
  if (options.is_maze()) return options.training ? "training" : "trial";
  return options.kind == "rest" ? "baseline" : "form";
}

}  // namespace

TaskTopics::TaskTopics(bus::Participant& participant, const OperatorConfig& config,
                       BeliefStore& store, const Clock& clock)
    : options_(config.task),
      method_(config.method ? std::string(Name(*config.method)) : ""),
      robots_(config.robots.size()),
      world_(OnlyWorld(config)),
      store_(store),
      clock_(clock),
      client_("study/" + UniqueId()),
      marks_(participant, bus::kStudyMark),
      task_(Robots(config), KindOf(config.task)),
      counted_at_(clock.Now()) {
  if (!world_.empty()) truth_.emplace(participant, bus::kTruth, world_);
  if (options_.kind == "form") form_ = OrStop(ReadStudyForm(options_.form), "operator.task.form: ");
  if (!options_.words.empty()) {
    words_ = OrStop(ReadFile(options_.words).and_then(ParsePageWords),
                    "operator.task.words: " + options_.words + ": ");
  }
  if (const auto text = ReadIfThere(options_.result)) {
    AdoptResult(Json::parse(*text, nullptr, false));
    return;
  }
  // Better known now than when the participant is done.
  if (const auto writable = CheckWritable(options_.result); !writable) {
    throw StartupError(kResultKey + writable.error().text);
  }
  AdoptProgress();
}

void TaskTopics::AdoptResult(const Json& result) {
  const bool is_result = result.is_object() && result.contains("duration_s");
  const bool is_measured = is_result && result.contains("mapping_accuracy");
  aborted_ = is_result && result.value("aborted", false);
  const bool may_lack =
      is_result && (!options_.is_maze() || aborted_ || result.value("timed_out", false));
  if (!is_measured && !may_lack) {
    throw StartupError(kResultKey + options_.result + " is no result of such a task");
  }
  mapping_accuracy_ = result.value("mapping_accuracy", 0.0);
  if (result.contains("answers")) progress_.answers = result["answers"].dump();
  task_.Finish();
}

void TaskTopics::AdoptProgress() {
  const auto text = ReadIfThere(draft_file());
  if (!text) return;
  progress_ = OrStop(ParseStepProgress(*text), kResultKey + draft_file() + ": ");
  if (progress_.began_at_s > 0.0) task_.Begin();
  task_.SetPaused(progress_.paused);
  StartShownTime();
  if (progress_.began_at_s > 0.0 && !progress_.paused) {  // for eye measures it was a pause
    PublishMark("pause begin", "", progress_.saved_at_s);
    PublishMark("pause end");
  }
  if (!progress_.paused || robots_ == 0) return;
  requests_.push_back({{}, client_, ++last_request_, "", StopRequest{{}, "paused"}});
}

void TaskTopics::Receive(const ControlRegistry& control) {
  driving_.clear();
  for (const auto& [name, robot] : control.robots()) {
    if (!robot.stop.stopped) driving_.insert(name);
  }
  if (!driving_.empty() && !progress_.paused) Begin();
}

void TaskTopics::Receive(const OperatorEvent& event) {
  const bool is_note = event.kind == RequestKind::kNote;
  const bool is_path = event.kind == RequestKind::kGuide && event.cells > 0;
  if (!event.accepted || finished() || !(is_note || is_path)) return;
  if (is_path) ++progress_.guidance;
  if (is_note && progress_.log.size() < kMostEntries) {
    progress_.log.push_back({WallSeconds(), "note", event.text});
    PublishMark("note", event.text);
  }
  if (const auto saved = Save(progress_); !saved) {
    LOG_WARNING("step not saved", "reason", saved.error().text);
  }
}

void TaskTopics::Step() {
  if (truth_) {
    for (const MapUpdate& truth : truth_->TakeValid(kToDomain)) task_.Receive(truth.cells);
  }
  CountTime();
  if (options_.kind == "form" && present_) Begin();
  const bool is_due = clock_.Now() >= save_due_at_;
  if (task_.phase() != TaskPhase::kRunning || !is_due) return;
  save_due_at_ = clock_.Now() + kSavePeriod;
  if (const auto saved = Save(progress_); !saved) {
    LOG_WARNING("step not saved", "reason", saved.error().text);
  }
}

void TaskTopics::CountTime() {
  const Clock::TimePoint now = clock_.Now();
  const double passed_s = std::chrono::duration<double>(now - counted_at_).count();
  counted_at_ = now;
  if (task_.phase() != TaskPhase::kRunning) return;
  (progress_.paused ? progress_.paused_s : progress_.used_s) += passed_s;
  const double limit_s = options_.limit_s();
  if (limit_s == 0.0 || progress_.used_s < limit_s || now < end_due_at_) return;
  end_due_at_ = now + kRetry;
  End end{.event = options_.is_maze() ? "timed out" : "finished"};
  if (auto measured = Measure(); options_.is_maze() && measured) end.measured = *measured;
  if (const auto done = Conclude(std::move(end)); !done) {
    LOG_ERROR("step not finished in time", "reason", done.error().text);
  }
}

void TaskTopics::StartShownTime() {
  const bool runs = task_.phase() == TaskPhase::kRunning && !progress_.paused;
  shown_used_s_ = progress_.used_s;
  shown_since_s_ = runs ? WallSeconds() : 0.0;
}

void TaskTopics::Begin() {
  if (task_.phase() != TaskPhase::kWaiting) return;
  task_.Begin();
  counted_at_ = clock_.Now();
  progress_.began_at_s = WallSeconds();
  progress_.log.push_back({progress_.began_at_s, "begun", ""});
  StartShownTime();
  PublishMark(MarkName(options_) + " begin");
  save_due_at_ = {};
}

std::string TaskTopics::CheckAllowed(const OperatorRequest& request) const {
  return request.client == client_ ? "" : task_.CheckAllowed(request);
}

BeliefStore::Answer TaskTopics::Finish(const OperatorRequest& request) {
  if (auto repeat = store_.FindRepeat(request)) return *std::move(repeat);
  if (std::string why = task_.CheckFinish(); !why.empty()) return {Refusal(request, why)};
  const auto done = Measure().and_then([&](const TaskResult& measured) {
    return Conclude({.event = "finished", .measured = measured});
  });
  if (!done) return {Refusal(request, done.error().text)};
  return store_.Keep(request, {});
}

OperatorReply TaskTopics::Answer(const StudyRequest& request) {
  CountTime();
  std::string refusal = Decide(request);
  if (!refusal.empty()) LOG_WARNING("refused", "client", request.client, "reason", refusal);
  return {request.client, request.id, refusal.empty(), std::move(refusal), 0};
}

std::string TaskTopics::Decide(const StudyRequest& request) {
  if (!request.step.empty() && request.step != options_.step) return "it is of another step";
  switch (request.kind) {
    case StudyRequest::Kind::kBegin:
      if (options_.kind != "rest") return "this step begins otherwise";
      if (progress_.paused) return "this step is paused";
      Begin();
      return "";
    case StudyRequest::Kind::kDraft:
      return KeepDraft(request.text);
    case StudyRequest::Kind::kAnswers:
      return TakeAnswers(request.text);
    case StudyRequest::Kind::kPause:
    case StudyRequest::Kind::kContinue:
      return SetPaused(request.kind == StudyRequest::Kind::kPause);
    case StudyRequest::Kind::kAbort:
      return Abort(request.text);
  }
  return "";
}

std::string TaskTopics::KeepDraft(const std::string& json) {
  if (!form_) return "this step has no form";
  if (finished()) return "this form is finished";
  auto answers = CheckedAnswers(json);
  if (!answers) return answers.error().text;
  StepProgress next = progress_;
  next.answers = *std::move(answers);
  if (const auto saved = Save(next); !saved) return saved.error().text;
  progress_ = std::move(next);
  return "";
}

std::string TaskTopics::TakeAnswers(const std::string& json) {
  if (!form_) return "this step has no form";
  auto answers = CheckedAnswers(json);
  if (!answers) return answers.error().text;
  if (finished()) return *answers == progress_.answers ? "" : "this form is finished";
  if (progress_.paused) return "this step is paused";
  Begin();
  const auto done = Conclude({.event = "finished", .answers = *answers});
  if (!done) return done.error().text;
  progress_.answers = *std::move(answers);
  return "";
}

std::string TaskTopics::SetPaused(bool paused) {
  if (finished()) return "this step is finished";
  if (paused == progress_.paused) return "";
  StepProgress next = progress_;
  next.paused = paused;
  next.log.push_back({WallSeconds(), paused ? "paused" : "continued", ""});
  if (paused) {
    ++next.pauses;
    next.resume = driving_;
  }
  if (const auto saved = Save(next); !saved) return saved.error().text;
  if (!paused) driving_ = next.resume;  // as they will, should the next pause come at once
  progress_ = std::move(next);
  task_.SetPaused(paused);
  StartShownTime();
  PublishMark(paused ? "pause begin" : "pause end");
  if (robots_ == 0) return "";
  if (paused) {
    requests_.push_back({{}, client_, ++last_request_, "", StopRequest{{}, "paused"}});
  } else if (!progress_.resume.empty()) {
    const std::vector<std::string> robots(progress_.resume.begin(), progress_.resume.end());
    requests_.push_back({{}, client_, ++last_request_, "", ResumeRequest{robots}});
  }
  return "";
}

std::string TaskTopics::Abort(const std::string& reason) {
  if (finished()) return aborted_ ? "" : "this step is finished";
  if (reason.size() > kLongestReason) {
    return fmt::format("a reason of {} bytes is longer than {}", reason.size(), kLongestReason);
  }
  End end{.event = "aborted", .reason = reason};
  if (auto measured = Measure(); options_.is_maze() && measured) end.measured = *measured;
  const auto done = Conclude(std::move(end));
  return done ? "" : done.error().text;
}

Result<TaskResult> TaskTopics::Measure() const {
  const Belief* belief = store_.FindBelief(world_);
  if (belief == nullptr) return Fail(ErrorCode::kRefused, "the map is not known yet");
  return store_.InitialMap(world_).and_then(
      [&](const std::optional<BeliefGrid>& initial) -> Result<TaskResult> {
        return task_.Measure(*belief, initial.value_or(belief->wall_probability));
      });
}

Result<void> TaskTopics::Conclude(End end) {
  auto written = WriteJsonFile(options_.result, ResultOf(end));
  if (!written) return written;
  std::error_code unknown;
  std::filesystem::remove(draft_file(), unknown);
  const bool had_begun = task_.phase() != TaskPhase::kWaiting;
  aborted_ = end.event == "aborted";
  progress_.log.push_back({WallSeconds(), end.event, end.reason});
  if (end.measured) mapping_accuracy_ = end.measured->mapping_accuracy;
  task_.Finish();
  task_.SetPaused(false);
  StartShownTime();
  just_finished_ = true;
  if (std::exchange(progress_.paused, false)) PublishMark("pause end");
  if (aborted_) PublishMark("aborted", end.reason);
  if (had_begun) PublishMark(MarkName(options_) + " end");
  if (robots_ > 0 && end.event != "finished") {
    requests_.push_back({{}, client_, ++last_request_, "", StopRequest{{}, end.event}});
  }
  return {};
}

Json TaskTopics::ResultOf(const End& end) const {
  Json json = {{"kind", options_.kind},
               {"step", options_.step},
               {"participant", options_.participant},
               {"number", options_.number}};
  if (options_.is_maze()) AddMaze(json, end);
  if (form_) {
    json["form"] = form_->name;
    if (!form_->version.empty()) json["version"] = Json::parse(form_->version);
    const std::string& answers = end.answers.empty() ? progress_.answers : end.answers;
    json["answers"] = answers.empty() ? Json::object() : Json::parse(answers);
    const auto passed = AttentionPassed(*form_, end.answers);
    if (passed && !end.answers.empty()) json["attention_passed"] = *passed;
  }
  const double now_s = WallSeconds();
  json["began_at"] = progress_.began_at_s > 0.0 ? progress_.began_at_s : now_s;
  json["finished_at"] = now_s;
  json["duration_s"] = progress_.used_s;
  json["paused_s"] = progress_.paused_s;
  json["pauses"] = progress_.pauses;
  json["aborted"] = end.event == "aborted";
  json["reason"] = end.reason;
  Json log = Json::array();
  for (const auto& [at_s, event, text] : progress_.log) {
    log.push_back({{"at", at_s}, {"event", event}, {"text", text}});
  }
  json["log"] = std::move(log);
  return json;
}

void TaskTopics::AddMaze(Json& json, const End& end) const {
  json["method"] = method_;
  json["layout"] = options_.layout;
  json["rotation"] = options_.rotation;
  json["training"] = options_.training;
  json["robots"] = robots_;
  json["timed_out"] = end.event == "timed out";
  if (end.measured) {
    json["mapping_accuracy"] = end.measured->mapping_accuracy;
    json["cell_accuracy"] = end.measured->cell_accuracy;
    json["initial_cell_accuracy"] = end.measured->initial_cell_accuracy;
    json["wrong_at_first"] = end.measured->wrong_at_first;
    json["corrected"] = end.measured->corrected;
    json["broken"] = end.measured->broken;
    json["edits"] = end.measured->edits;
  }
  const RobotSums sums = task_.sums();
  json["pictures"] = sums.images;
  json["image_bytes"] = sums.image_bytes;
  json["low_level_steps"] = sums.low_level_steps;
  json["cell_moves"] = sums.cell_moves;
  json["guidance"] = progress_.guidance;
  json["goals"] = sums.goals_total;
  json["goals_reached"] = sums.goals_reached;
  json["goals_total"] = sums.goals_total;
}

Result<void> TaskTopics::Save(StepProgress progress) {
  progress.saved_at_s = WallSeconds();
  return WriteDurableFile(draft_file(), ToText(progress));
}

void TaskTopics::PublishMark(const std::string& label, const std::string& text, double at_s) {
  conav_msgs::msg::StudyMark mark;
  mark.header(ToHeader(SimTime::FromSeconds(at_s)));
  mark.utc(at_s);
  mark.label(label);
  const std::vector<std::pair<std::string, std::string>> facts = {
      {"participant", options_.participant},
      {"step", options_.step},
      {"method", method_},
      {"layout", options_.layout},
      {"number", std::to_string(options_.number)},
      {"text", text}};
  for (const auto& [key, value] : facts) {
    if (value.empty()) continue;
    mark.keys().push_back(key);
    mark.values().push_back(value);
  }
  bus::Send(marks_, mark);
}

std::vector<console::Update> TaskTopics::TakeUpdates() {
  std::vector<console::Update> updates;
  const bool is_first = !shown_;
  if (const TaskStatus now = status(); shown_ != now) {
    shown_ = now;
    console::Task& task = *updates.emplace_back().mutable_task();
    task = ToConsole(options_, now);
    task.mutable_words()->insert(words_.begin(), words_.end());
  }
  if (is_first && form_) updates.emplace_back().mutable_form()->set_json(form_->json);
  if (form_ && shown_answers_ != progress_.answers) {
    shown_answers_ = progress_.answers;
    updates.emplace_back().mutable_draft()->set_json(progress_.answers);
  }
  if (std::exchange(shown_entries_, progress_.log.size()) == progress_.log.size()) return updates;
  console::StudyLog* log = updates.emplace_back().mutable_study_log();
  for (const auto& [at_s, event, text] : progress_.log) {
    console::StudyEntry* entry = log->add_entries();
    entry->set_time(at_s);
    entry->set_event(event);
    entry->set_text(text);
  }
  return updates;
}

TaskStatus TaskTopics::status() const {
  return {.phase = task_.phase(),
          .goals_left = task_.sums().goals_left,
          .may_finish = !progress_.paused && task_.CheckFinish().empty(),
          .mapping_accuracy = mapping_accuracy_,
          .used_s = shown_used_s_,
          .since_s = shown_since_s_,
          .paused = progress_.paused,
          .aborted = aborted_};
}

}  // namespace conav::operators
