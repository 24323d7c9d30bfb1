#include "study/live/session.h"

#include <fmt/core.h>
#include <sys/random.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <utility>

#include "common/cli/cli.h"
#include "common/runtime/clock.h"
#include "common/runtime/file.h"
#include "common/runtime/log.h"
#include "common/runtime/text.h"
#include "common/segments/segment.h"
#include "launcher/bus_session.h"
#include "study/record_store.h"

namespace conav::live_study {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kTokenDays = 30.0;
constexpr const char* kDesign = "participant.json";
constexpr const char* kLog = "log.jsonl";

/// log.jsonl, a line for each event.
class SessionLog {
 public:
  explicit SessionLog(AppendedFile file) : file_(std::move(file)) {}

  void Add(const std::string& event, const Json& more = Json::object()) {
    AddAt(WallSeconds(), event, more);
  }
  void AddAt(double at_s, const std::string& event, const Json& more) {
    Json line{{"at", at_s}, {"event", event}};
    line.update(more);
    const auto written = file_.Append(line.dump() + "\n");
    if (!written) Say("log.jsonl: " + written.error().text);
  }

 private:
  AppendedFile file_;
};

/// Finds a domain without foreign robots; it need not listen there first.
launcher::DomainLease FindDomain(const SessionOptions& options) {
  launcher::Episode episode = launcher::MakeEpisode(1, 1);
  launcher::BusSession session = launcher::JoinFreeDomain(DemoOf(options, {}), episode);
  session.observer.reset();
  return std::move(session.lease);
}

Result<void> MakeFolders(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (!error) return {};
  return Fail(ErrorCode::kIo,
              fmt::format("{}: cannot create this folder: {}", path.string(), error.message()));
}

/// Letters and digits that only the study's folder gives away.
Result<std::string> SecretOf(const fs::path& folder) {
  constexpr std::size_t kBytes = 16;
  const fs::path file = folder / "secret";
  if (!fs::exists(file)) {
    unsigned char bytes[kBytes];
    DEMAND(getrandom(bytes, kBytes, 0) == static_cast<ssize_t>(kBytes));
    std::string text;
    for (const unsigned char byte : bytes) text += fmt::format("{:02x}", byte);
    if (auto written = WriteSecretFile(file, text + "\n"); !written) {
      return tl::unexpected(written.error());
    }
  }
  auto text = ReadFile(file);
  if (!text || text->size() == 2 * kBytes + 1) return text;
  return Fail(ErrorCode::kMalformed, file.string() + " is no secret; remove it");
}

/// Opens the folder of the participant, which no other session uses then. Errors: kRefused: it has
/// another design, whose first difference is named, other files, or is in use; kIo.
Result<SessionLog> OpenFolder(const fs::path& folder, const ParticipantPlan& plan) {
  if (auto made = MakeFolders(folder); !made) return tl::unexpected(made.error());
  const Json design = DesignOf(plan);
  const auto text = ReadFile(folder / kDesign);
  if (text) {
    Json there = Json::parse(*text, nullptr, false);
    if (!there.is_object()) {
      return Fail(ErrorCode::kMalformed, (folder / kDesign).string() + ": is no JSON object");
    }
    there.erase("started");
    if (std::string difference = study::Difference(there, design); !difference.empty()) {
      return Fail(ErrorCode::kRefused,
                  fmt::format("{} belongs to another session: {}; choose another --out",
                              folder.string(), difference));
    }
  } else {
    for (const auto& entry : fs::directory_iterator(folder)) {
      const std::string name = entry.path().filename();
      if (name == kLog || name.starts_with(std::string(kDesign) + ".")) continue;
      return Fail(ErrorCode::kRefused,
                  folder.string() + " is not empty and contains no participant");
    }
  }
  auto log = AppendedFile::Continue(folder / kLog);
  if (!log && log.error().code == ErrorCode::kUnavailable) {
    return Fail(ErrorCode::kRefused, folder.string() + " is in use by another session");
  }
  if (!log) return tl::unexpected(log.error());
  if (!text) {
    Json document = design;
    document["started"] = WallSeconds();
    if (auto written = WriteJsonFile(folder / kDesign, document); !written) {
      return tl::unexpected(written.error());
    }
  }
  return SessionLog(*std::move(log));
}

bool ReachesCriterion(const Step& step, const Json& result) {
  return result.value("mapping_accuracy", 0.0) >= step.criterion.mapping_accuracy;
}

}  // namespace

Result<std::optional<Json>> ReadStepResult(const std::filesystem::path& file) {
  const auto text = ReadFile(file);
  if (!text && text.error().code == ErrorCode::kNotFound) return std::nullopt;
  if (!text) return tl::unexpected(text.error());
  if (text->empty()) return std::nullopt;  // a power cut took it
  auto result = Json::parse(*text, nullptr, false);
  if (result.is_object() && result.contains("finished_at")) return result;
  return Fail(ErrorCode::kMalformed, file.string() + " is not the result of a step");
}

bool Progress::aborted() const {
  return std::ranges::any_of(
      results, [](const auto& entry) { return entry.second.value("aborted", false); });
}

std::optional<std::size_t> Progress::Next(const ParticipantPlan& plan) const {
  const std::size_t last = plan.steps.size() - 1;
  for (std::size_t index = aborted() ? last : 0; index < plan.steps.size(); ++index) {
    const Step& step = plan.steps[index];
    if (results.contains(index)) continue;
    if (aborted() && !step.is_page()) continue;
    if (step.attempt > 1) {
      const auto before = results.find(index - 1);
      if (before == results.end() || ReachesCriterion(step, before->second)) continue;
    }
    return index;
  }
  return std::nullopt;
}

std::string FolderName(const ParticipantPlan& plan, std::size_t index) {
  return fmt::format("{:0{}}-{}", index + 1, plan.steps.size() > 99 ? 3 : 2,
                     plan.steps.at(index).id);
}

namespace {

Json EntryOf(const ParticipantPlan& plan, std::size_t index, const Json& result) {
  const Step& step = plan.steps[index];
  Json entry{{"step", step.id}, {"folder", FolderName(plan, index)}, {"number", step.number}};
  entry.update(result);
  entry.erase("participant");
  entry.erase("log");  // is in log.jsonl
  if (step.method) entry["method"] = Name(*step.method);
  if (step.part > 0) entry["part"] = step.part;
  if (!step.is_maze()) return entry;
  entry.update(MazeFacts(step));
  if (step.training) {
    entry["attempt"] = step.attempt;
    entry["criterion_reached"] = ReachesCriterion(step, result);
  }
  if (step.method == MethodKind::kMapping) {
    entry["valid"] = result.value("mapping_accuracy", 0.0) > kAcceptedMappingAccuracy;
  }
  return entry;
}

/// Of the mapping task, over its mazes.
Json MappingSummary(const ParticipantPlan& plan, const Json& steps) {
  double sum = 0.0;
  std::size_t valid = 0;
  for (const Json& step : steps) {
    sum += step.value("mapping_accuracy", 0.0);
    valid += step.value("valid", false) ? 1 : 0;
  }
  const auto count = static_cast<double>(steps.size());
  return {{"mazes_wanted", plan.steps.size()},
          {"mazes_finished", steps.size()},
          {"mazes_valid", valid},
          {"mean_mapping_accuracy", steps.empty() ? 0.0 : sum / count}};
}

}  // namespace

Json ResultJson(const ParticipantPlan& plan, const Progress& progress,
                const std::string& completion_code) {
  Json steps = Json::array();
  for (const auto& [index, result] : progress.results) {
    steps.push_back(EntryOf(plan, index, result));
  }
  const bool done = !progress.Next(plan);
  Json json{{"participant", plan.participant},
            {"complete", done && !progress.aborted()},
            {"aborted", progress.aborted()}};
  for (const auto& [index, result] : progress.results) {
    if (result.value("aborted", false)) json["reason"] = result.value("reason", "");
  }
  if (done && !completion_code.empty()) json["completion_code"] = completion_code;
  if (plan.protocol.empty()) json.update(MappingSummary(plan, steps));
  json["steps"] = std::move(steps);
  return json;
}

std::string ResultLine(const Step& step, const Json& result) {
  std::string line = fmt::format("{}  {:.0f} s", step.id, result.value("duration_s", 0.0));
  if (step.is_maze()) {
    line += fmt::format("  mapping accuracy {:.1f} %  edits {}  pictures {}",
                        100.0 * result.value("mapping_accuracy", 0.0), result.value("edits", 0),
                        result.value("pictures", 0));
  }
  if (result.value("timed_out", false)) line += "  time limit";
  if (result.value("aborted", false)) line += "  aborted: " + result.value("reason", "");
  return line;
}

namespace {

/// One participant's way through the steps.
class Session {
 public:
  /// Throws launcher::UsageError when the DDS domain is taken.
  Session(const ParticipantPlan& plan, const SessionOptions& options, fs::path folder,
          const StudyFacts& facts, SessionLog log)
      : plan_(plan),
        options_(options),
        facts_(facts),
        folder_(std::move(folder)),
        log_(std::move(log)),
        domain_(FindDomain(options)),
        port_(options.port) {}

  /// True when all steps are finished. Errors: kIo, kMalformed; kUnavailable: a service cannot run.
  /// Throws StartupError as RunStep does.
  Result<bool> Run(const StopToken& stop) {
    if (auto ready = Prepare(); !ready) return tl::unexpected(ready.error());
    while (const auto index = progress_.Next(plan_)) {
      if (stop.stop_requested()) return false;
      if (const auto played = Play(*index, stop); !played || !*played) return played;
    }
    return WriteReport().map([] { return true; });
  }

  std::string completion_code() const { return completion_code_; }
  const Progress& progress() const { return progress_; }

 private:
  /// Reads what earlier sessions left; makes codes and tokens.
  Result<void> Prepare() {
    const std::set<std::string> logged = LoggedEnds();
    for (std::size_t index = 0; index < plan_.steps.size(); ++index) {
      auto result = ReadStepResult(folder_ / FolderName(plan_, index) / "result.json");
      if (!result) return tl::unexpected(result.error());
      if (!*result) continue;
      progress_.results.emplace(index, **result);
      if (logged.contains(plan_.steps[index].id)) continue;
      // The session was killed between the result and this.
      if (auto stored = Store(index, **result); !stored) return stored;
    }
    if (!progress_.results.empty()) {
      Say(fmt::format("{} of {} steps are finished", progress_.results.size(), plan_.count()));
    }
    const bool draws_code = facts_.completion_code == "random";
    completion_code_ = draws_code ? "" : facts_.completion_code;
    if (!draws_code && !options_.is_remote()) return {};
    const auto secret = SecretOf(facts_.folder);
    if (!secret) return tl::unexpected(secret.error());
    if (draws_code) completion_code_ = Drawn(*secret, "completion", 8);
    return options_.is_remote() ? MakeTokens(*secret) : Result<void>();
  }

  /// The steps whose end the log has.
  std::set<std::string> LoggedEnds() const {
    std::set<std::string> steps;
    std::istringstream log(ReadFile(folder_ / kLog).value_or(""));
    for (std::string line; std::getline(log, line);) {
      const Json entry = Json::parse(line, nullptr, false);
      if (!entry.is_object()) continue;  // a kill cut it off
      const std::string event = entry.value("event", "");
      if (event == "step_finished" || event == "aborted") steps.insert(entry.value("step", ""));
    }
    return steps;
  }

  std::string Drawn(const std::string& secret, const std::string& purpose, std::size_t size) const {
    return Sha256Hex(secret + purpose + plan_.participant).substr(0, size);
  }

  /// The same ones in each session of the participant.
  Result<void> MakeTokens(const std::string& secret) {
    constexpr std::size_t kDigits = 32;
    constexpr double kDayS = 86400.0;
    participant_token_ = Drawn(secret, "participant", kDigits);
    experimenter_token_ = Drawn(secret, "experimenter", kDigits);
    const double ends_s = WallSeconds() + kTokenDays * kDayS;
    using console::ROLE_ADMIN;
    using console::ROLE_OPERATOR;
    return operators::WriteTokens(
        TokenFile(), {{"participant", ROLE_OPERATOR, Sha256Hex(participant_token_), ends_s},
                      {"experimenter", ROLE_ADMIN, Sha256Hex(experimenter_token_), ends_s}});
  }
  fs::path TokenFile() const { return options_.is_remote() ? folder_ / "tokens.json" : fs::path(); }

  Result<StepFolder> MakeFolder(std::size_t index) const {
    const Step& step = plan_.steps[index];
    const StepFolder folder{folder_ / FolderName(plan_, index)};
    for (const char* part : {"config", "logs"}) {
      if (auto made = MakeFolders(folder.path / part); !made) return tl::unexpected(made.error());
    }
    if (step.kind != Part::Kind::kText) return folder;
    return WriteFile(folder.text_form(), TextForm(step.title, step.text)).map([&] {
      return folder;
    });
  }

  /// False if interrupted.
  Result<bool> Play(std::size_t index, const StopToken& stop) {
    const Step& step = plan_.steps[index];
    const bool resumes = fs::exists(folder_ / FolderName(plan_, index));
    const auto folder = MakeFolder(index);
    if (!folder) return tl::unexpected(folder.error());
    StepSetting setting{.plan = plan_,
                        .options = options_,
                        .step = step,
                        .folder = *folder,
                        .participant_folder = folder_,
                        .forms = facts_.folder,
                        .domain = domain_.domain(),
                        .port = port_,
                        .token_file = TokenFile()};
    for (const auto& [earlier, result] : progress_.results) {
      const bool has_map = plan_.steps[earlier].is_maze() && result.contains("mapping_accuracy");
      if (has_map) setting.earlier.push_back(result["mapping_accuracy"]);
    }
    if (index + 1 == plan_.steps.size()) setting.completion_code = completion_code_;
    if (resumes && step.method == MethodKind::kMapping) BeginAgain(*folder);
    log_.Add("step_begun", {{"step", step.id}, {"number", step.number}, {"resumed", resumes}});
    Result<void> stored;
    const StepEnd end = RunStep(
        setting, [&](const std::string& url) { ReportOpen(step, url); },
        [&] {
          stored = ReadStepResult(folder->result()).and_then([&](const auto& result) {
            return Store(index, *result);
          });
        },
        [&](const std::string& event, const Json& more) { log_.Add(event, more); }, stop);
    port_ = setting.port;
    if (end == StepEnd::kFinished) return stored.map([] { return true; });
    log_.Add("interrupted", {{"step", step.id}});
    if (end == StepEnd::kInterrupted) return false;
    return Fail(ErrorCode::kUnavailable,
                fmt::format("step {} was interrupted; the same command resumes there", step.id));
  }

  /// What was corrected before the kill would be missing from the segment of the picture that is shown
  /// again.
  static void BeginAgain(const StepFolder& folder) {
    for (const auto& entry : fs::directory_iterator(folder.path)) {
      const std::string name = entry.path().filename();
      const bool is_state = name.starts_with("operator.db") ||
                            name.find(".checkpoint") != std::string::npos ||
                            name.ends_with(".draft");
      if (is_state) fs::remove(entry.path());
    }
  }

  void ReportOpen(const Step& step, const std::string& url) {
    std::string text = fmt::format("{} of {}  {}", step.number, plan_.count(), step.id);
    if (step.is_maze()) {
      text += fmt::format(" (method {}, maze {}, {} degrees)", Name(*step.method), step.seed,
                          step.rotation_deg);
    }
    std::string base = options_.public_url.empty() ? url : options_.public_url;
    while (base.ends_with('/')) base.pop_back();
    const auto link = [&](const std::string& query, const std::string& token) {
      return base + query + (token.empty() ? "" : "#token=" + token);
    };
    Say(fmt::format("{}: {}", text, link("/", participant_token_)));
    if (!plan_.experimenter || said_experimenter_) return;
    said_experimenter_ = true;
    Say("experimenter: " + link("/?experimenter", experimenter_token_));
  }

  Result<void> Store(std::size_t index, const Json& result) {
    const Step& step = plan_.steps[index];
    progress_.results.insert_or_assign(index, result);
    for (const Json& entry : result.value("log", Json::array())) {
      std::string event = entry.value("event", "");
      if (event == "continued") event = "resumed";
      if (event != "paused" && event != "resumed" && event != "note") continue;
      log_.AddAt(entry.value("at", 0.0), event,
                 {{"step", step.id}, {"text", entry.value("text", "")}});
    }
    const bool aborted = result.value("aborted", false);
    Json event{{"step", step.id}, {"duration_s", result.value("duration_s", 0.0)}};
    if (aborted) event["reason"] = result.value("reason", "");
    log_.Add(aborted ? "aborted" : "step_finished", event);
    Say(ResultLine(step, result));
    return WriteReport();
  }

  Result<void> WriteReport() const {
    return WriteJsonFile(folder_ / "result.json", ResultJson(plan_, progress_, completion_code_));
  }

  const ParticipantPlan& plan_;
  const SessionOptions& options_;
  const StudyFacts& facts_;
  const fs::path folder_;
  SessionLog log_;
  launcher::DomainLease domain_;
  Progress progress_;
  std::string completion_code_;
  std::string participant_token_;
  std::string experimenter_token_;
  bool said_experimenter_ = false;
  int port_;
};

}  // namespace

int RunSession(const std::string& program, const ParticipantPlan& plan,
               const SessionOptions& options, const std::filesystem::path& folder,
               const StudyFacts& facts) {
  if (const auto port = launcher::CheckPort("--port", options.port); !port) {
    return Failed(program, port.error());
  }
  auto log = OpenFolder(folder, plan);
  if (!log && log.error().code == ErrorCode::kRefused) return Refused(program, log.error().text);
  if (!log) return Failed(program, log.error());
  Session session(plan, options, folder, facts, *std::move(log));
  Say("participant " + options.participant + "  folder " + folder.string());
  const auto done = session.Run(ProcessStopToken());
  if (!done) return Failed(program, done.error());
  if (!*done) {
    Say("interrupted; the same command resumes");
    return 1;
  }
  Say(session.progress().aborted() ? "the session was aborted" : "all steps are finished");
  if (!session.completion_code().empty()) Say("completion code " + session.completion_code());
  return 0;
}

int RunGuarded(const std::string& program, const std::function<int()>& command) {
  log::SetService("study-session");
  log::SetMinimumLevel(log::Level::kWarning);
  InstallStopSignals();
  try {
    return command();
  } catch (const launcher::UsageError& error) {
    return Refused(program, error.what());
  } catch (const std::exception& error) {
    return Failed(program, {ErrorCode::kUnavailable, error.what()});
  }
}

}  // namespace conav::live_study
