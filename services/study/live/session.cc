#include "study/live/session.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/random.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <list>
#include <utility>

#include "common/cli/cli.h"
#include "common/runtime/clock.h"
#include "common/runtime/file.h"
#include "common/runtime/log.h"
#include "common/runtime/text.h"
#include "common/segments/segment.h"
#include "launcher/bus_session.h"
#include "launcher/process.h"
#include "study/record_store.h"

namespace conav::live_study {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using Json = nlohmann::ordered_json;

constexpr int kPeriodMs = 50;
constexpr int kLingerMs = 1000;
constexpr auto kGrace = 5s;
constexpr std::size_t kLogLines = 8;
constexpr double kTokenDays = 30.0;
constexpr const char* kDesign = "participant.json";
constexpr const char* kLog = "log.jsonl";

void Say(const std::string& line) {
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

void WaitAMoment() { poll(nullptr, 0, kPeriodMs); }

/// A step continues without them.
bool IsOptional(const std::string& service) {
  return service == kRecorder || service == kEyeTracker;
}

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

enum class StepEnd { kFinished, kInterrupted, kFailed };

/// Runs the services of one step until its result is there. Throws StartupError if a service cannot
/// start or a file cannot be written.
class StepRun {
 public:
  using Opened = std::function<void(const std::string& url)>;

  /// `setting.port`, once it is known, is the page's.
  StepRun(const fs::path& program_folder, StepSetting& setting, SessionLog& log, Opened opened)
      : program_folder_(program_folder), setting_(setting), log_(log), opened_(std::move(opened)) {}

  /// All services have ended on return.
  StepEnd Run(const StopToken& stop) {
    std::error_code ignored;
    fs::remove(setting_.folder.url(), ignored);  // of a session before
    for (PlannedService& planned : PlanStep(setting_)) {
      services_.push_back({std::move(planned), {}, {}, {}, nullptr});
      Start(services_.back());
    }
    const StepEnd end = Wait(stop);
    // Pages still fetch the result.
    const int moments = end == StepEnd::kFinished ? kLingerMs / kPeriodMs : 0;
    for (int i = 0; i < moments && !stop.stop_requested(); ++i) WaitAMoment();
    StopAll(end);
    return end;
  }

 private:
  struct Service {
    PlannedService planned;
    launcher::RestartPolicy policy;
    Clock::TimePoint started;
    std::optional<Clock::TimePoint> restart_at;  // while it is dead
    launcher::Process* process;
  };

  void Start(Service& service) {
    const std::string& name = service.planned.name;
    const fs::path config = setting_.folder.config(name);
    if (const auto written = WriteFile(config, service.planned.config); !written) {
      throw StartupError(written.error().text);
    }
    service.started = clock_.Now();
    service.restart_at.reset();
    service.process = &processes_.Start(
        name, {(program_folder_ / ("conav-" + name)).string(), "--config", config.string()},
        setting_.folder.log(name));
  }

  StepEnd Wait(const StopToken& stop) {
    for (bool open = false;; WaitAMoment()) {
      const auto url = open ? Result<std::string>() : ReadFile(setting_.folder.url());
      if (!open && url) {
        open = true;
        const std::string line = url->substr(0, url->find('\n'));
        setting_.port = std::stoi(line.substr(line.rfind(':') + 1));
        opened_(line);
      }
      if (fs::exists(setting_.folder.result())) return StepEnd::kFinished;
      if (!KeepAlive()) return StepEnd::kFailed;
      if (stop.stop_requested()) return StepEnd::kInterrupted;
    }
  }

  /// Starts what died again; false when a service cannot go on without which there is no step.
  bool KeepAlive() {
    bool goes_on = true;
    for (const launcher::Process* process : processes_.TakeEnded()) {
      const auto service = std::ranges::find(services_, process, &Service::process);
      const auto restart = service->policy.Ended(*process->end(), service->started, clock_.Now());
      if (restart) service->restart_at = *restart;
      goes_on = goes_on && (restart || IsOptional(process->name()));
      ReportDeath(*process, restart ? "" : restart.error().text);
    }
    for (Service& service : services_) {
      if (service.restart_at && clock_.Now() >= *service.restart_at) Restart(service);
    }
    return goes_on;
  }

  void Restart(Service& service) {
    for (PlannedService& planned : PlanStep(setting_)) {  // with the page's port
      if (planned.name == service.planned.name) service.planned = std::move(planned);
    }
    Start(service);
    Say(fmt::format("restarted {} (pid {})", service.planned.name, service.process->pid()));
    log_.Add("restarted", {{"step", setting_.step.id}, {"process", service.planned.name}});
  }

  /// `why_not`: why it does not start again; empty = it does.
  void ReportDeath(const launcher::Process& process, const std::string& why_not) {
    const std::string how = process.end()->Describe();
    log_.Add("process_died",
             {{"step", setting_.step.id}, {"process", process.name()}, {"end", how}});
    Say(fmt::format("{} (pid {}) died: {}{}{}; the end of its log:", process.name(), process.pid(),
                    how, why_not.empty() ? "" : "; ", why_not));
    for (const std::string& line :
         launcher::LastLines(process.log(), why_not.empty() ? 1 : kLogLines)) {
      Say("  | " + line);
    }
  }

  /// The recorder last, so that it sees the others end.
  void StopAll(StepEnd end) {
    for (Service& service : services_) {
      // A simulator that ends when asked begins again the next time.
      const bool kills = end != StepEnd::kFinished && service.planned.name == kSimulator;
      if (kills) service.process->Signal(SIGKILL);
    }
    const auto is_seen = [](const launcher::Process& process) {
      return process.name() != kRecorder;
    };
    auto killed = processes_.Stop(kGrace, is_seen);
    std::ranges::move(processes_.StopAll(kGrace), std::back_inserter(killed));
    for (const std::string& name : killed) {
      if (name != kSimulator) Say(name + " did not stop on request and was killed");
    }
  }

  const fs::path& program_folder_;
  StepSetting& setting_;
  SessionLog& log_;
  Opened opened_;
  SteadyClock clock_;
  launcher::ProcessGroup processes_;
  std::list<Service> services_;
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
  return ReadFile(file);
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
  return fmt::format("{:02}-{}", index + 1, plan.steps.at(index).id);
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
  /// Throws StartupError as StepRun does.
  Result<bool> Run(const StopToken& stop) {
    if (auto ready = Prepare(); !ready) return tl::unexpected(ready.error());
    log_.Add("session_begun", {{"finished", progress_.results.size()}});
    while (const auto index = progress_.Next(plan_)) {
      if (stop.stop_requested()) return false;
      const auto result = Play(*index, stop);
      if (!result) return tl::unexpected(result.error());
      if (!*result) return false;
      if (auto stored = Store(*index, **result); !stored) return tl::unexpected(stored.error());
    }
    log_.Add("session_finished", {{"aborted", progress_.aborted()}});
    return WriteReport().map([] { return true; });
  }

  std::string completion_code() const { return completion_code_; }
  const Progress& progress() const { return progress_; }

 private:
  /// Reads what earlier sessions left; makes codes and tokens.
  Result<void> Prepare() {
    for (std::size_t index = 0; index < plan_.steps.size(); ++index) {
      auto result = ReadStepResult(folder_ / FolderName(plan_, index) / "result.json");
      if (!result) return tl::unexpected(result.error());
      if (*result) progress_.results.emplace(index, **result);
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

  /// Empty if interrupted.
  Result<std::optional<Json>> Play(std::size_t index, const StopToken& stop) {
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
    log_.Add("step_begun", {{"step", step.id}, {"number", step.number}, {"resumed", resumes}});
    StepRun run(program_folder_, setting, log_,
                [&](const std::string& url) { ReportOpen(step, url); });
    const StepEnd end = run.Run(stop);
    port_ = setting.port;
    if (end == StepEnd::kFinished) return ReadStepResult(folder->result());
    log_.Add("interrupted", {{"step", step.id}});
    if (end == StepEnd::kInterrupted) return std::nullopt;
    return Fail(ErrorCode::kUnavailable,
                fmt::format("step {} was interrupted; the same command resumes there", step.id));
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
      log_.AddAt(entry.value("at", 0.0), entry.value("event", ""),
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
  const fs::path program_folder_ = fs::read_symlink("/proc/self/exe").parent_path();
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
