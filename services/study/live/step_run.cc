#include <fmt/core.h>
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <list>
#include <utility>

#include "common/cli/cli.h"
#include "common/runtime/clock.h"
#include "common/runtime/config.h"
#include "common/runtime/file.h"
#include "launcher/bus_session.h"
#include "launcher/process.h"
#include "operator/config.h"
#include "operator/recording/config.h"
#include "planner/config.h"
#include "sim/config.h"
#include "study/live/session.h"

// One step: the configurations of its services, from their own structs, and how they run.

namespace conav::live_study {
namespace {

constexpr const char* kWorld = "w1";
constexpr const char* kRecorder = "recorder";
constexpr const char* kSimulator = "sim";
constexpr const char* kEyeTracker = "eye-tracker";

bus::ParticipantOptions BusOf(const StepSetting& setting, const std::string& service) {
  const auto vendors = *launcher::VendorOfService(setting.options.dds);
  return launcher::BusOptions(DemoOf(setting.options, setting.step), setting.domain,
                              vendors.at(service));
}

std::vector<std::string> RobotNames(const Step& step) {
  std::vector<std::string> names;
  const int count = step.is_maze() ? step.maze.robots : 0;
  for (int robot = 1; robot <= count; ++robot) names.push_back(fmt::format("r{}", robot));
  return names;
}

/// "w1/r1", ...
std::vector<std::string> RobotsOf(const Step& step) {
  std::vector<std::string> robots = RobotNames(step);
  for (std::string& name : robots) name = fmt::format("{}/{}", kWorld, name);
  return robots;
}

std::string MethodName(const Step& step) {
  return step.method ? std::string(Name(*step.method)) : "";
}

std::string RecorderYaml(const StepSetting& setting) {
  const Step& step = setting.step;
  recorder::RecorderConfig config;
  config.bus = BusOf(setting, kRecorder);
  config.robots = RobotsOf(step);
  config.file = (setting.folder.path / "recording.mcap").string();
  config.facts = {{"run", setting.folder.path.filename().string()},
                  {"participant", setting.plan.participant},
                  {"step", step.id},
                  {"method", MethodName(step)}};
  if (step.is_maze()) {
    config.facts.insert({{"seed", std::to_string(step.seed)},
                         {"world_seed", std::to_string(step.seed)},
                         {"rotation_deg", std::to_string(step.rotation_deg)},
                         {"world", step.maze.preset},
                         {"speed", fmt::format("{}", step.maze.speed)}});
  }
  return DumpConfig(kRecorder, config);
}

std::string SimYaml(const StepSetting& setting) {
  const Step& step = setting.step;
  sim::SimConfig config;
  config.bus = BusOf(setting, kSimulator);
  config.world = kWorld;
  config.robots = RobotNames(step);
  config.seed = step.seed;
  config.rotation_deg = step.rotation_deg;
  config.preset = step.maze.preset;
  config.camera.mode = step.maze.camera;
  config.camera.stream = NeedsLiveView(*step.method);
  config.speed = step.maze.speed;
  config.checkpoint = (setting.folder.path / "w1.checkpoint").string();
  return DumpConfig(kSimulator, config);
}

operators::SegmentOptions SegmentsOf(const StepSetting& setting) {
  const Step& step = setting.step;
  operators::SegmentOptions recording;
  recording.participant = setting.plan.participant;
  recording.session = fmt::format("{}-{}", setting.plan.participant, step.id);
  if (!step.is_maze()) return recording;
  recording.file = (setting.participant_folder / "segments.pb.zst").string();
  std::string maze = step.maze.preset;
  if (step.rotation_deg != 0) maze += fmt::format(" rotated {}", step.rotation_deg);
  recording.mazes = {fmt::format("{}={}@{}", kWorld, maze, step.seed)};
  recording.pictures = true;
  return recording;
}

operators::TaskOptions TaskOf(const StepSetting& setting) {
  const Step& step = setting.step;
  operators::TaskOptions task;
  task.kind = KindName(step);
  task.step = step.id;
  task.participant = setting.plan.participant;
  task.number = step.number;
  task.count = setting.plan.count();
  task.title = step.title;
  task.result = setting.folder.result().string();
  task.language = setting.plan.language;
  if (!setting.plan.words.empty()) task.words = (setting.forms / setting.plan.words).string();
  task.introduction = step.text;
  task.experimenter = setting.plan.experimenter;
  task.tags = setting.plan.eye_tracker.tags;
  task.completion_code = setting.completion_code;
  if (step.kind == Part::Kind::kForm) task.form = (setting.forms / step.form).string();
  if (step.kind == Part::Kind::kText) task.form = setting.folder.text_form().string();
  if (step.kind == Part::Kind::kRest) task.rest_s = step.rest_s;
  if (!step.is_maze()) return task;
  task.show_scores = step.maze.show_scores;
  if (task.show_scores) task.earlier = setting.earlier;
  task.feedback = step.maze.feedback;
  task.time_limit_s = step.maze.time_limit_s;
  task.training = step.training;
  task.layout = std::to_string(step.seed);
  task.rotation = step.rotation_deg;
  return task;
}

std::string OperatorYaml(const StepSetting& setting) {
  const SessionOptions& options = setting.options;
  operators::OperatorConfig config;
  config.bus = BusOf(setting, "operator");
  config.robots = RobotsOf(setting.step);
  config.database = (setting.folder.path / "operator.db").string();
  if (setting.step.is_maze()) config.method = setting.step.method;
  config.control.start_stopped = true;
  config.console.port = setting.port;
  config.console.url_file = setting.folder.url().string();
  config.console.address = options.address;
  config.console.tls = options.tls;
  config.console.insecure = options.insecure;
  config.console.token_file = setting.token_file.string();
  if (!options.public_url.empty()) config.console.origins = {options.public_url};
  config.recording = SegmentsOf(setting);
  config.task = TaskOf(setting);
  return DumpConfig("operator", config);
}

std::string PlannerYaml(const StepSetting& setting) {
  constexpr double kPerRobotS = 5.0;  // paths are drawn one by one
  const Step& step = setting.step;
  planner::PlannerConfig config;
  config.bus = BusOf(setting, "planner");
  config.robots = RobotsOf(step);
  config.method = *step.method;
  config.seed = step.seed;
  config.perception = "embedded";
  // The planner asks no model.
  if (step.method == MethodKind::kMapping) config.perception_model = PerceptionModelKind::kGlpf;
  // People need more time.
  config.first_guidance_timeout_s = std::max(8.0, kPerRobotS * step.maze.robots);
  config.answer_timeout_s = 60.0;
  config.timeout_clock = "simulation";
  return DumpConfig("planner", config);
}

/// Section `eye_tracker:` of conav-eye-tracker.
struct EyeTrackerSection {
  bus::ParticipantOptions bus;
  std::string address;

  void Visit(ConfigReader& reader) {
    reader.Section("bus", bus);
    reader.Field("address", address);
  }
};

std::string EyeTrackerYaml(const StepSetting& setting) {
  return DumpConfig("eye_tracker",
                    EyeTrackerSection{BusOf(setting, kRecorder), setting.plan.eye_tracker.address});
}

}  // namespace

launcher::DemoOptions DemoOf(const SessionOptions& options, const Step& step) {
  launcher::DemoOptions demo;
  demo.seed = step.seed;
  demo.rotation_deg = step.rotation_deg;
  demo.robots = step.maze.robots;
  demo.preset = step.maze.preset;
  demo.camera = step.maze.camera;
  demo.speed = step.maze.speed;
  demo.dds = options.dds;
  demo.domain = options.domain;
  demo.console = options.port;
  if (!options.out.empty()) demo.out = options.out;
  return demo;
}

std::filesystem::path StepFolder::config(const std::string& service) const {
  return path / "config" / (service + ".yaml");
}

std::filesystem::path StepFolder::log(const std::string& service) const {
  return path / "logs" / (service + ".log");
}

std::vector<PlannedService> PlanStep(const StepSetting& setting) {
  std::vector<PlannedService> services{{kRecorder, RecorderYaml(setting)}};
  if (!setting.plan.eye_tracker.address.empty()) {
    services.push_back({kEyeTracker, EyeTrackerYaml(setting)});
  }
  if (setting.step.is_maze()) services.push_back({kSimulator, SimYaml(setting)});
  services.push_back({"operator", OperatorYaml(setting)});
  if (setting.step.is_maze()) services.push_back({"planner", PlannerYaml(setting)});
  return services;
}

namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr int kPeriodMs = 50;
constexpr int kLingerMs = 1000;
constexpr int kCodeLingerMs = 10 * 60 * 1000;
constexpr auto kGrace = 5s;
constexpr std::size_t kLogLines = 8;

void WaitAMoment() { poll(nullptr, 0, kPeriodMs); }

/// A step continues without them.
bool IsOptional(const std::string& service) {
  return service == kRecorder || service == kEyeTracker;
}

/// Runs the services of one step until its result is there. Throws StartupError if a service cannot
/// start or a file cannot be written.
class StepRun {
 public:
  StepRun(StepSetting& setting, const OpenListener& opened, const FinishListener& finished,
          const EventListener& report)
      : setting_(setting), opened_(opened), finished_(finished), report_(report) {}

  /// All services have ended on return.
  StepEnd Run(const StopToken& stop) {
    try {
      return RunServices(stop);
    } catch (...) {
      StopAll(StepEnd::kFailed);
      throw;
    }
  }

 private:
  StepEnd RunServices(const StopToken& stop) {
    std::error_code ignored;
    fs::remove(setting_.folder.url(), ignored);  // of a session before
    for (PlannedService& planned : PlanStep(setting_)) {
      services_.push_back({std::move(planned), {}, {}, {}, nullptr});
      Start(services_.back());
    }
    const StepEnd end = Wait(stop);
    if (end == StepEnd::kFinished) finished_();
    // Pages still fetch the result; one that is elsewhere has time for its code.
    const bool has_code = setting_.options.is_remote() && !setting_.completion_code.empty();
    const int linger_ms = has_code ? kCodeLingerMs : kLingerMs;
    const int moments = end == StepEnd::kFinished ? linger_ms / kPeriodMs : 0;
    for (int i = 0; i < moments && !stop.stop_requested(); ++i) WaitAMoment();
    StopAll(end);
    return end;
  }

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
      ReportEyeTracker();
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
    report_("restarted", {{"step", setting_.step.id}, {"process", service.planned.name}});
  }

  /// When there is none, and when it came then: what its service logged.
  void ReportEyeTracker() {
    if (setting_.plan.eye_tracker.address.empty() || clock_.Now() < look_at_tracker_) return;
    look_at_tracker_ = clock_.Now() + 1s;
    for (const std::string& line : launcher::LastLines(setting_.folder.log(kEyeTracker), 1)) {
      const bool lacks = line.find("no eye tracker") != std::string::npos ||
                         line.find("eye tracker lost") != std::string::npos;
      const bool came = lacks_tracker_ && line.find("eye tracker connected") != std::string::npos;
      if (lacks_tracker_ ? came : lacks) {
        Say("  | " + line);
        lacks_tracker_ = lacks;
      }
    }
  }

  /// `why_not`: why it does not start again; empty = it does.
  void ReportDeath(const launcher::Process& process, const std::string& why_not) {
    const std::string how = process.end()->Describe();
    report_("process_died",
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
      if (kills && service.process != nullptr) service.process->Signal(SIGKILL);
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

  const fs::path program_folder_ = fs::read_symlink("/proc/self/exe").parent_path();
  StepSetting& setting_;
  const OpenListener& opened_;
  const FinishListener& finished_;
  const EventListener& report_;
  SteadyClock clock_;
  launcher::ProcessGroup processes_;
  std::list<Service> services_;
  Clock::TimePoint look_at_tracker_{};
  bool lacks_tracker_ = false;
};

}  // namespace

void Say(const std::string& line) {
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

void AddSessionOptions(CLI::App& app, SessionOptions& options) {
  app.add_option("--participant", options.participant,
                 "Code of the participant, a pseudonym: 1 to 40 of A-Z a-z 0-9 _ -")
      ->required()
      ->type_name("CODE");
  AddNumber(app, "--port", options.port, "Port of the page; 0 = any free one", 0, 65535);
  AddShown(app, "--address", options.address,
           "Address to listen on; other machines need TLS, and get tokens");
  app.add_option("--tls-certificate", options.tls.certificate, "PEM file, with its chain");
  app.add_option("--tls-key", options.tls.key, "PEM file");
  app.add_flag("--insecure", options.insecure,
               "Tokens may cross the network in clear: it is trusted, or a proxy adds TLS");
  app.add_option(
      "--public-url", options.public_url,
      "Address under which participants reach the page, such as https://study.example.org");
  app.add_option("--dds", options.dds, "cyclonedds, fastdds, mixed or SERVICE=VENDOR,...");
  app.add_option("--domain", options.domain, "DDS domain [CONAV_DOMAIN or the first free one]");
}

Result<void> Validate(const SessionOptions& options) {
  if (!IsCode(options.participant, "_-")) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("--participant '{}': not 1 to 40 of A-Z a-z 0-9 _ -", options.participant));
  }
  operators::GatewayOptions console;
  console.port = options.port;
  console.address = options.address;
  console.tls = options.tls;
  console.insecure = options.insecure;
  if (options.is_remote()) console.token_file = "tokens.json";
  if (!options.public_url.empty()) console.origins = {options.public_url};
  console.origins_key = "--public-url";
  if (auto ok = operators::CheckAccess(console); !ok) return ok;
  return launcher::Validate(DemoOf(options, {}));
}

StepEnd RunStep(StepSetting& setting, const OpenListener& opened, const FinishListener& finished,
                const EventListener& report, const StopToken& stop) {
  return StepRun(setting, opened, finished, report).Run(stop);
}

}  // namespace conav::live_study
