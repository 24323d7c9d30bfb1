#include "study/live_results.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <utility>

#include "common/runtime/file.h"
#include "study/statistics/moments.h"

namespace conav::study {
namespace {

namespace fs = std::filesystem;

constexpr std::pair<ParticipantState, const char*> kStateNames[] = {
    {ParticipantState::kComplete, "complete"},   {ParticipantState::kIncomplete, "incomplete"},
    {ParticipantState::kAborted, "aborted"},     {ParticipantState::kMalformed, "malformed"},
    {ParticipantState::kOther, "not asked for"},
};

/// Empty if there is no such file. Errors: kIo, kMalformed; both name the file.
Result<std::optional<Json>> ReadObject(const fs::path& file) {
  const auto text = ReadFile(file);
  if (!text && text.error().code == ErrorCode::kNotFound) return std::nullopt;
  if (!text) return tl::unexpected(text.error());
  try {
    auto json = Json::parse(*text);
    if (json.is_object()) return json;
    return Fail(ErrorCode::kMalformed, file.string() + ": is not a JSON object");
  } catch (const Json::exception& error) {
    return Fail(ErrorCode::kMalformed, fmt::format("{}: {}", file.string(), error.what()));
  }
}

/// The answers to a matrix become "question.row".
Json Flattened(const Json& answers) {
  Json flat = Json::object();
  for (const auto& [question, answer] : answers.items()) {
    if (!answer.is_object()) {
      flat[question] = answer;
      continue;
    }
    for (const auto& [row, value] : answer.items()) flat[question + "." + row] = value;
  }
  return flat;
}

std::string TextOf(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || found->is_null()) return {};
  return found->is_string() ? found->get<std::string>() : found->dump();
}

bool IsTrue(const Json& object, const char* key) { return TextOf(object, key) == "true"; }

LiveForm FormOf(const Json& result, const std::string& file) {
  LiveForm form{.form = fs::path(result.at("form").get<std::string>()).stem().string(),
                .step = result.at("step").get<std::string>(),
                .file = file,
                .version = TextOf(result, "version"),
                .answers = Flattened(result.at("answers"))};
  if (result.contains("attention_passed"))
    form.attention_passed = IsTrue(result, "attention_passed");
  return form;
}

/// One participant, file by file. Throws Json::exception for a value that is missing or of another
/// type; `file()` is the file it is missing in.
class ParticipantReader {
 public:
  explicit ParticipantReader(const fs::path& folder) : folder_(folder) {
    participant_.name = folder.filename().string();
  }

  LiveParticipant Read() {
    try {
      if (auto read = ReadAll(); !read) Refuse(read.error().text);
    } catch (const Json::exception& error) {
      Refuse(fmt::format("{}: {}", (folder_.parent_path() / file_).string(), error.what()));
    }
    return std::move(participant_);
  }

 private:
  void Refuse(const std::string& reason) {
    participant_.state = ParticipantState::kMalformed;
    participant_.reason = reason;
    participant_.file = file_;
    participant_.trials.clear();
    participant_.forms.clear();
  }

  /// Names the file in `file_`, too. Empty if there is none.
  Result<std::optional<Json>> ReadHere(const std::string& name) {
    file_ = participant_.name + "/" + name;
    return ReadObject(folder_ / name);
  }

  Result<void> ReadAll() {
    auto design = ReadHere("participant.json");
    if (!design) return tl::unexpected(design.error());
    if (!*design) return Fail(ErrorCode::kMalformed, file_ + ": is missing");
    participant_.design = *std::move(*design);
    if (const auto who = participant_.design.at("participant").get<std::string>();
        who != participant_.name) {
      return Fail(ErrorCode::kMalformed, fmt::format("{}: is of participant {}", file_, who));
    }
    auto result = ReadHere("result.json");
    if (!result) return tl::unexpected(result.error());
    const Json steps = *result ? (*result)->at("steps") : Json::array();
    for (const Json& step : steps) {
      if (auto taken = TakeStep(step); !taken) return taken;
    }
    file_ = participant_.name + "/result.json";
    SetState(result->value_or(Json::object()), steps);
    CheckDesign();
    ReadLog();
    return {};
  }

  /// The step's own file says more than the list of all; what the list alone has (the maze of the
  /// design) is kept.
  Result<void> TakeStep(const Json& listed) {
    file_ = participant_.name + "/result.json";
    Json result = listed;
    const auto folder = listed.at("folder").get<std::string>();
    auto own = ReadHere(fs::path(folder).filename().string() + "/result.json");
    if (!own) return tl::unexpected(own.error());
    if (*own) result.update(**own);
    if (!*own) file_ = participant_.name + "/result.json";
    const auto kind = result.at("kind").get<std::string>();
    const auto step = result.at("step").get<std::string>();
    for (const Json& part : participant_.design.at("parts")) {
      if (TextOf(part, "step") != step) continue;
      result.update(part);  // the design knows best which maze it was, and whether for training
    }
    if (kind == "form" && !IsTrue(result, "aborted")) TakeForm(result);
    if (kind == "study") TakeMaze(step, std::move(result));
    return {};
  }

  /// The design names the method that a form is about; before its mazes it is the participant's.
  void TakeForm(const Json& result) {
    const std::string method = TextOf(result, "method");
    bool of_trial = false;
    for (LiveTrial& trial : participant_.trials) {
      if (trial.method != method) continue;
      trial.forms.push_back(FormOf(result, file_));
      of_trial = true;
    }
    if (of_trial) return;
    LiveForm form = FormOf(result, file_);
    const bool is_again = std::ranges::find(participant_.forms, form.form, &LiveForm::form) !=
                          participant_.forms.end();
    if (is_again) form.form = TextOf(result, "step");  // columns of its own
    participant_.forms.push_back(std::move(form));
  }

  void TakeMaze(const std::string& step, Json result) {
    NoteMaze(step, result);
    if (IsTrue(result, "training") || IsTrue(result, "aborted")) return;
    LiveTrial trial{.step = step,
                    .file = file_,
                    .method = result.at("method").get<std::string>(),
                    .layout = TextOf(result, "layout"),
                    .position = static_cast<int>(participant_.trials.size()) + 1,
                    .result = std::move(result)};
    if (!trial.Number("duration_s")) {
      throw Json::other_error::create(501, "duration_s is not a number", nullptr);
    }
    participant_.trials.push_back(std::move(trial));
  }

  void NoteMaze(const std::string& step, const Json& result) {
    const auto note = [&](std::string text) {
      participant_.deviations.push_back({step, std::move(text), file_});
    };
    if (IsTrue(result, "training")) {
      if (TextOf(result, "criterion_reached") == "false") {
        note(fmt::format("attempt {} did not reach the criterion", result.value("attempt", 1)));
      }
      return;
    }
    if (IsTrue(result, "timed_out")) note("ended by its time limit");
    if (const auto pauses = TextOf(result, "pauses"); !pauses.empty() && pauses != "0") {
      note(fmt::format("paused {}, {:.1f} s in all",
                       pauses == "1" ? std::string("once") : pauses + " times",
                       result.value("paused_s", 0.0)));
    }
  }

  void SetState(const Json& result, const Json& steps) {
    participant_.file = file_;
    const auto count = steps.size();
    const std::string last = count == 0 ? std::string("no step finished")
                                        : fmt::format("{} steps finished, the last is {}", count,
                                                      TextOf(steps.back(), "step"));
    if (IsTrue(result, "aborted")) {
      participant_.state = ParticipantState::kAborted;
      std::string why = TextOf(result, "reason");
      for (const Json& step : steps) {
        if (why.empty() && IsTrue(step, "aborted")) why = TextOf(step, "reason");
      }
      participant_.reason = last + (why.empty() ? "" : ": " + why);
    } else if (IsTrue(result, "complete")) {
      participant_.state = ParticipantState::kComplete;
    } else {
      participant_.reason = last;
    }
  }

  /// Of a participant who is complete: the mazes were those of the design, in its order.
  void CheckDesign() {
    if (!participant_.counts()) return;
    const std::string file = participant_.name + "/participant.json";
    std::vector<std::string> planned;
    std::set<std::string> seeds;
    for (const Json& part : participant_.design.at("parts")) {
      const std::string seed = TextOf(part, "seed");
      if (!seed.empty() && !seeds.insert(seed + "@" + TextOf(part, "rotation")).second) {
        participant_.deviations.push_back(
            {TextOf(part, "step"), fmt::format("maze {} occurs twice", seed), file});
      }
      if (!IsTrue(part, "training") && TextOf(part, "kind") == "study") {
        planned.push_back(TextOf(part, "step"));
      }
    }
    std::vector<std::string> done;
    for (const LiveTrial& trial : participant_.trials) done.push_back(trial.step);
    for (const std::string& step : planned) {
      if (std::ranges::find(done, step) != done.end()) continue;
      participant_.deviations.push_back({step, "a part of the design has no result", file});
    }
    if (done != planned && std::ranges::is_permutation(done, planned)) {
      participant_.deviations.push_back(
          {"", "the parts were not in the order of the design", file});
    }
  }

  /// Steps that begin and end are no news, but one that is resumed is; a line that cannot be read is
  /// a deviation, not an error.
  void ReadLog() {
    static const std::set<std::string> ordinary{"step_begun", "step_finished", "paused", "resumed"};
    const auto text = ReadFile(folder_ / "log.jsonl");
    if (!text) return;
    const std::string file = participant_.name + "/log.jsonl";
    std::size_t number = 0;
    double last_at_s = 0.0;  // wall time of the last line
    for (std::size_t begin = 0; begin < text->size();) {
      const std::size_t end = std::min(text->find('\n', begin), text->size());
      const auto line = Json::parse(text->substr(begin, end - begin), nullptr, false);
      begin = end + 1;
      ++number;
      if (!line.is_object()) {
        participant_.deviations.push_back(
            {"", fmt::format("line {} of the log cannot be read", number), file});
        continue;
      }
      std::string event = TextOf(line, "event");
      if (IsTrue(line, "resumed") && last_at_s > 0.0) {
        participant_.deviations.push_back({TextOf(line, "step"),
                                           fmt::format("resumed {:.0f} s after the last entry",
                                                       line.value("at", 0.0) - last_at_s),
                                           file});
      }
      last_at_s = line.value("at", last_at_s);
      if (ordinary.contains(event)) continue;
      for (const auto& [key, value] : line.items()) {
        if (key == "at" || key == "event" || key == "step") continue;
        event += fmt::format(", {} {}", key, AnswerText(value));
      }
      participant_.deviations.push_back({TextOf(line, "step"), event, file});
    }
  }

  const fs::path folder_;
  std::string file_;
  LiveParticipant participant_;
};

/// Errors: kMalformed.
Result<ScoreRule> RuleOf(const std::string& form, const std::string& name, const Json& json) {
  ScoreRule rule{.name = name, .form = form};
  try {
    const auto kind = json.at("kind").get<std::string>();
    rule.items = json.at("of").get<std::vector<std::string>>();
    rule.reversed = json.value("reversed", std::vector<std::string>());
    rule.min = json.value("min", rule.min);
    if (!rule.reversed.empty()) rule.max = json.at("max").get<double>();
    if (kind == "sus") rule.kind = ScoreRule::Kind::kSus;
    if (kind != "sus" && kind != "mean") {
      return Fail(ErrorCode::kMalformed, fmt::format("score {}: kind {}: mean or sus", name, kind));
    }
  } catch (const Json::exception& error) {
    return Fail(ErrorCode::kMalformed, fmt::format("score {}: {}", name, error.what()));
  }
  if (rule.items.empty() || (rule.kind == ScoreRule::Kind::kSus && rule.items.size() != 10)) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("score {}: of {} questions", name, rule.items.size()));
  }
  return rule;
}

Result<void> ReadForms(LiveStudy& study) {
  std::error_code missing;
  for (const auto& entry : fs::recursive_directory_iterator(study.folder / "forms", missing)) {
    if (entry.path().extension() != ".json") continue;
    auto form = ReadObject(entry.path());
    if (!form) return tl::unexpected(form.error());
    study.forms[entry.path().stem().string()] = *std::move(*form);
  }
  for (const auto& [name, form] : study.forms) {
    if (!form.contains("scoring")) continue;
    for (const auto& [score, json] : form["scoring"].items()) {
      auto rule = RuleOf(name, score, json);
      if (!rule) {
        return Fail(ErrorCode::kMalformed,
                    fmt::format("{}: {}", (study.folder / "forms" / (name + ".json")).string(),
                                rule.error().text));
      }
      study.scores.push_back(*std::move(rule));
    }
  }
  return {};
}

void ReadEyes(const fs::path& folder, LiveParticipant& participant,
              std::vector<std::string>& problems) {
  auto measured = gaze::MeasureParticipant(folder);
  if (!measured) {
    problems.push_back(measured.error().text);
    return;
  }
  for (std::string& problem : measured->problems) {
    participant.deviations.push_back(
        {"", "eye tracking: " + std::move(problem), folder.filename()});
  }
  for (gaze::StepEyeMeasures& step : measured->trials) {
    for (LiveTrial& trial : participant.trials) {
      if (trial.step == step.step) trial.eye = std::move(step.measures);
    }
  }
}

Result<void> ReadParticipants(LiveStudy& study) {
  std::error_code error;
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(study.folder, error)) {
    const bool is_participant =
        fs::exists(entry.path() / "participant.json") || fs::exists(entry.path() / "result.json");
    if (entry.is_directory() && is_participant) folders.push_back(entry.path());
  }
  if (error) {
    return Fail(ErrorCode::kNotFound,
                fmt::format("{}: {}", study.folder.string(), error.message()));
  }
  if (folders.empty()) {
    return Fail(ErrorCode::kNotFound,
                fmt::format("{}: no participant in it (a folder with participant.json)",
                            study.folder.string()));
  }
  std::ranges::sort(folders);
  for (const fs::path& folder : folders) {
    LiveParticipant participant = ParticipantReader(folder).Read();
    if (participant.state == ParticipantState::kMalformed) {
      study.problems.push_back(participant.reason);
    } else {
      ReadEyes(folder, participant, study.problems);
    }
    study.participants.push_back(std::move(participant));
  }
  return {};
}

Result<void> Choose(LiveStudy& study, const std::vector<std::string>& only) {
  for (const std::string& name : only) {
    if (std::ranges::find(study.participants, name, &LiveParticipant::name) ==
        study.participants.end()) {
      return Fail(ErrorCode::kNotFound,
                  fmt::format("{}: no participant {}", study.folder.string(), name));
    }
  }
  for (LiveParticipant& participant : study.participants) {
    const bool wanted = only.empty() || std::ranges::find(only, participant.name) != only.end();
    if (wanted || !participant.counts()) continue;
    participant.state = ParticipantState::kOther;
    participant.reason = "not named by --participants";
  }
  return {};
}

/// Design of the protocol: all participants went through the same one.
void CheckProtocols(LiveStudy& study) {
  std::map<std::string, std::string> first;
  for (LiveParticipant& participant : study.participants) {
    const std::string protocol = TextOf(participant.design, "protocol_fingerprint");
    if (participant.state == ParticipantState::kMalformed || protocol.empty()) continue;
    if (first.empty()) first.emplace(protocol, participant.name);
    if (first.contains(protocol)) continue;
    participant.deviations.push_back(
        {"", fmt::format("another protocol than {}'s", first.begin()->second),
         participant.name + "/participant.json"});
  }
}

std::optional<double> NumberIn(const Json& object, const std::string& key) {
  const auto found = object.find(key);
  if (found == object.end()) return std::nullopt;
  if (found->is_number()) return found->get<double>();
  if (!found->is_string()) return std::nullopt;
  const auto& text = found->get_ref<const std::string&>();
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number =
      error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
  return is_number ? std::optional(value) : std::nullopt;
}

}  // namespace

const char* Name(ParticipantState state) {
  const auto* found =
      std::ranges::find(kStateNames, state, &std::pair<ParticipantState, const char*>::first);
  return found->second;
}

std::optional<double> LiveForm::Number(const std::string& question) const {
  return NumberIn(answers, question);
}

std::optional<double> LiveTrial::Number(const std::string& key) const {
  return NumberIn(result, key);
}

std::optional<double> Score(const ScoreRule& rule, const LiveForm& form) {
  std::vector<double> values;
  for (const std::string& item : rule.items) {
    const auto answer = form.Number(item);
    if (!answer) return std::nullopt;
    if (rule.kind == ScoreRule::Kind::kSus) {
      if (*answer < 1.0 || *answer > 5.0) return std::nullopt;
      values.push_back(values.size() % 2 == 0 ? *answer - 1.0 : 5.0 - *answer);
      continue;
    }
    const bool is_reversed = std::ranges::find(rule.reversed, item) != rule.reversed.end();
    if (is_reversed && (*answer < rule.min || *answer > rule.max)) return std::nullopt;
    values.push_back(is_reversed ? rule.max + rule.min - *answer : *answer);
  }
  // The mean of ten items from 0 to 4, times 25, is 2.5 times their sum.
  return statistics::Mean(values) * (rule.kind == ScoreRule::Kind::kSus ? 25.0 : 1.0);
}

std::vector<std::string> LiveStudy::Methods() const {
  std::set<std::string> methods;
  for (const LiveParticipant& participant : participants) {
    if (!participant.counts()) continue;
    for (const LiveTrial& trial : participant.trials) methods.insert(trial.method);
  }
  return {methods.begin(), methods.end()};
}

std::size_t LiveStudy::CountOf(ParticipantState state) const {
  return static_cast<std::size_t>(std::ranges::count(participants, state, &LiveParticipant::state));
}

Result<LiveStudy> ReadLiveStudy(const fs::path& folder, const std::vector<std::string>& only) {
  LiveStudy study{.folder = folder};
  if (auto read = ReadForms(study); !read) return tl::unexpected(read.error());
  if (auto read = ReadParticipants(study); !read) return tl::unexpected(read.error());
  if (auto chosen = Choose(study, only); !chosen) return tl::unexpected(chosen.error());
  CheckProtocols(study);
  return study;
}

}  // namespace conav::study
