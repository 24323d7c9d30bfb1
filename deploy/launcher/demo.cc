#include "launcher/demo.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <set>

#include "common/runtime/file.h"
#include "common/runtime/log.h"
#include "common/runtime/text.h"

namespace conav::launcher {

std::string PlannerMonitor::Fold(const PlannerLease& lease) {
  std::vector<std::string> robots;
  std::set<std::string> before;
  for (const PlannerLease::Held& held : lease.holds) {
    Driver& driver = drivers_[held.robot];
    if (held.lease_epoch <= driver.lease_epoch) continue;
    if (driver.instance != lease.instance) {
      robots.push_back(held.robot);
      if (!driver.node.empty()) before.insert(driver.node);
    }
    driver = {held.lease_epoch, lease.node, lease.instance};
  }
  if (robots.empty() || (before.empty() && !reports_first_)) return "";
  if (before.empty()) return fmt::format("{} drives {}", lease.node, Join(robots, ", "));
  return fmt::format("{} took over {} from {}", lease.node, Join(robots, ", "), Join(before, ", "));
}

namespace {

const char* Name(EndReason reason) {
  constexpr const char* kNames[] = {"all goals reached", "process died", "time limit",
                                    "interrupted"};  // in the order of the reasons
  return kNames[static_cast<std::size_t>(reason)];
}

/// Empty while there is no such file.
std::string FirstLine(const std::filesystem::path& file) {
  const auto text = ReadFile(file);
  return text ? text->substr(0, text->find('\n')) : "";
}

std::string WeightsText(const DemoOptions& options) {
  if (options.effective_model() == PerceptionModelKind::kGlpf) return "";
  return options.weights.empty() ? "shipped" : options.weights.string();
}

nlohmann::ordered_json Versions() {
  nlohmann::ordered_json versions{{"conav", CONAV_VERSION}};
  // ./conav passes the commit that it built; a program run by hand has none.
  if (const char* commit = std::getenv("CONAV_COMMIT")) versions["commit"] = commit;
  return versions;
}

using namespace std::chrono_literals;

constexpr auto kGrace = 5s;
constexpr auto kPeriod = 50ms;
// At the end: how long the bus must be quiet, and how long to wait for that.
constexpr auto kQuiet = 300ms;
constexpr auto kQuietLimit = 3s;
// Without its planner, a robot ends its last command within the command's expiry.
constexpr auto kStandStillLimit = 15s;
constexpr std::size_t kLogLines = 8;
constexpr std::uintmax_t kMostLogBytes = std::uintmax_t{64} << 20;  // and as many of before

std::string KilledLine(const std::string& process) {
  return process + " did not stop on request and was killed";
}

/// Several processes of a service are called "planner-1", "sim-w2".
bool IsOf(const std::string& service, const Process& process) {
  return process.name() == service || process.name().starts_with(service + "-");
}

/// The planner has a model of its own.
bool CanDoWithout(const Process& process) {
  return IsOf("nhpm", process) || process.name() == kRecorderName;
}

bool StandsStill(const RobotRecord& robot) {
  return !robot.state || robot.state->command_outcome != CommandOutcome::kRunning;
}

}  // namespace

nlohmann::ordered_json OutcomeJson(const DemoOptions& options, const Outcome& outcome,
                                   const EpisodeMetrics& metrics) {
  const std::string preset = options.map.empty() ? WorldOptionsOf(options, 0).preset : "";
  nlohmann::ordered_json json{{"seed", options.seed},
                              {"maze_seed", options.world_seed()},
                              {"rotation_deg", options.rotation_deg},
                              {"method", Name(options.method)},
                              {"search", options.search},
                              {"mapping_value", nullptr},
                              {"scenario", options.scenario},
                              {"communication", options.communication},
                              {"model", Name(options.effective_model())},
                              {"weights", WeightsText(options)},
                              {"weights_checksum", outcome.weights_checksum},
                              {"person", options.person},
                              {"person_weights", options.person_weights.string()},
                              {"nhpm_replicas", options.nhpm_processes()},
                              {"planners", options.planners},
                              {"x_source", options.x_source},
                              {"dds", outcome.dds},
                              {"worlds", options.worlds},
                              {"robots_per_world", options.robots},
                              {"simulated_operator", options.simulated_operator},
                              {"preset", preset},
                              {"map", options.map.string()},
                              {"perception", options.perception},
                              {"camera", options.camera},
                              {"speed", options.effective_speed()},
                              {"domain", outcome.domain},
                              {"ended", Name(outcome.reason)},
                              {"detail", outcome.detail},
                              {"restarts", outcome.restarts},
                              {"wall_s", outcome.wall_s},
                              {"run", outcome.run_folder},
                              {"versions", Versions()}};
  if (outcome.mapping_value) json["mapping_value"] = *outcome.mapping_value;
  json.update(ToJson(metrics));
  return json;
}

std::string OutcomeLine(const Outcome& outcome) {
  const std::string what = outcome.reason == EndReason::kProcessDied && !outcome.detail.empty()
                               ? outcome.detail
                               : Name(outcome.reason);
  return fmt::format("ended after {:.1f} s: {}", outcome.wall_s, what);
}

std::string RestartsLine(const Outcome& outcome) {
  std::vector<std::string> parts;
  for (const auto& [process, count] : outcome.restarts) {
    parts.push_back(fmt::format("{} {}", process, count));
  }
  return Join(parts, ", ");
}

Demo::Demo(const DemoOptions& options, std::filesystem::path program_folder, const Clock& clock,
           Progress& progress, std::optional<DomainLease> kept)
    : options_(options),
      program_folder_(std::move(program_folder)),
      clock_(clock),
      start_(clock.Now()),
      episode_(EpisodeOf(options)),
      session_(kept ? JoinKeptDomain(options, *std::move(kept), episode_)
                    : JoinFreeDomain(options, episode_)),
      run_(options.out, std::chrono::system_clock::now(), options.seed),
      progress_(progress),
      planners_(options.planners > 1) {
  episode_.open = options.is_open();
  episode_.robot_radius_m = WorldOptionsOf(options, 0).robot_radius_m;
  episode_.shared_goals = options.shared_goals;
  outcome_.dds = options.dds.empty() ? session_.participant->vendor() : options.dds;
  outcome_.domain = session_.lease.domain();
  outcome_.run_folder = run_.path().string();
  outcome_.weights_checksum = WeightsChecksum(options);
  if (options.method == MethodKind::kIgMcts) {
    outcome_.mapping_value = SearchOf(options).mapping_value;
  }
}

DemoResult Demo::Run(const StopToken& stop, const OnTurn& on_turn) {
  progress_.Say(fmt::format("seed {}  method {}  dds {}  domain {}  run {}", options_.seed,
                            Name(options_.method), outcome_.dds, outcome_.domain,
                            outcome_.run_folder));
  StartProcesses();
  start_ = clock_.Now();
  Follow(stop, on_turn);
  outcome_.wall_s = ElapsedSeconds();
  if (outcome_.reason != EndReason::kAllGoalsReached) {
    // First, so that nothing commands the robots.
    Stop([](const Process& process) { return IsOf("planner", process); });
  }
  TakeLastSamples();
  progress_.Finish(episode_);
  progress_.Say(OutcomeLine(outcome_));
  if (!outcome_.restarts.empty()) progress_.Say("restarts: " + RestartsLine(outcome_));
  if (outcome_.reason == EndReason::kProcessDied) ReportPositions();
  if (options_.waits_for_operator() && outcome_.reason == EndReason::kAllGoalsReached) {
    StayOpen(stop);
  }
  session_.observer.reset();  // the planned exit of the services is not news
  StopAll();
  return Finish();
}

void Demo::StartProcesses() {
  for (PlannedProcess& planned : PlanDemo(options_, outcome_.domain, episode_, run_)) {
    run_.Write(run_.config(planned.name), planned.config);
    services_.push_back({std::move(planned), {}, {}, {}});
  }
  for (Service& service : services_) {
    const Process& process = Start(service);
    progress_.Say(fmt::format("started {} (pid {})", process.name(), process.pid()));
  }
}

const Process& Demo::Start(Service& service) {
  service.started = clock_.Now();
  service.restart_at.reset();
  return processes_.Start(service.planned.name,
                          CommandLine(service.planned, options_, program_folder_, run_),
                          run_.log(service.planned.name));
}

double Demo::ElapsedSeconds() const {
  return std::chrono::duration<double>(clock_.Now() - start_).count();
}

void Demo::Follow(const StopToken& stop, const OnTurn& on_turn) {
  while (true) {
    session_.participant->Wait(kPeriod);
    session_.observer->Take();
    if (on_turn) on_turn(processes_.running());
    progress_.Show(episode_);
    ReportDrivers();
    ReportConsole();
    if (std::string death = KeepAlive(); !death.empty()) {
      outcome_.reason = EndReason::kProcessDied;
      outcome_.detail = std::move(death);
      return;
    }
    if (!options_.endless && episode_.finished()) {
      outcome_.reason = EndReason::kAllGoalsReached;
      return;
    }
    if (stop.stop_requested()) {
      outcome_.reason = EndReason::kInterrupted;
      return;
    }
    if (ElapsedSeconds() > options_.effective_time_limit_s()) {
      outcome_.reason = EndReason::kTimeLimit;
      return;
    }
  }
}

void Demo::KeepPorts() {
  const auto port_of = [](const std::string& url, int port) {
    return url.empty() ? port : std::atoi(url.c_str() + url.rfind(':') + 1);
  };
  DemoOptions options = options_;
  options.console = port_of(console_, options_.console_port());
  options.foxglove = port_of(foxglove_, options_.foxglove);
  for (const PlannedProcess& planned : PlanDemo(options, outcome_.domain, episode_, run_)) {
    if (planned.name == "operator") run_.Write(run_.config(planned.name), planned.config);
  }
}

std::string Demo::KeepAlive() {
  std::string ends_run;
  for (const Process* process : processes_.TakeEnded()) {
    const auto service = std::ranges::find(services_, process->name(), [](const Service& one) {
      return std::string_view(one.planned.name);
    });
    std::string what = fmt::format("{} (pid {}) died: {}", process->name(), process->pid(),
                                   process->end()->Describe());
    const auto restart = service->policy.Ended(*process->end(), service->started, clock_.Now());
    if (!restart) what += "; " + restart.error().text;
    if (restart) {
      service->restart_at = *restart;
    } else if (CanDoWithout(*process)) {
      what += "; the run continues without it";
    } else {
      ends_run = what;
      died_service_ = process->name().substr(0, process->name().find("-w"));
    }
    progress_.Say(what + "; the end of its log:");
    for (const std::string& line : LastLines(process->log(), restart ? 1 : kLogLines)) {
      progress_.Say("  | " + line);
    }
  }
  if (ends_run.empty()) RestartDue();
  for (const Service& service : services_) LimitLog(run_.log(service.planned.name), kMostLogBytes);
  return ends_run;
}

void Demo::RestartDue() {
  for (Service& service : services_) {
    if (!service.restart_at || clock_.Now() < *service.restart_at) continue;
    if (service.planned.name == "operator") KeepPorts();
    const Process& process = Start(service);
    progress_.Say(fmt::format("restarted {} (pid {}), restart {}", process.name(), process.pid(),
                              ++outcome_.restarts[process.name()]));
  }
}

void Demo::ReportDrivers() {
  for (const PlannerLease& lease : session_.observer->TakeLeases()) {
    const std::string line = planners_.Fold(lease);
    if (!line.empty()) progress_.Say(line);
  }
}

void Demo::Stop(const std::function<bool(const Process&)>& meant) {
  for (const std::string& name : processes_.Stop(kGrace, meant)) progress_.Say(KilledLine(name));
}

void Demo::ReportConsole() {
  if (options_.foxglove >= 0 && foxglove_.empty()) {
    foxglove_ = FirstLine(run_.foxglove_url());
    if (!foxglove_.empty()) progress_.Say(fmt::format("foxglove {}", foxglove_));
  }
  if (options_.console_port() < 0 || !console_.empty()) return;
  console_ = FirstLine(run_.console_url());
  if (console_.empty()) return;
  progress_.Say(fmt::format("console {}", console_));
  if (options_.waits_for_operator()) {
    progress_.Say("open it in a browser: the robots wait for you; Ctrl-C ends");
  }
}

void Demo::StayOpen(const StopToken& stop) {
  progress_.Say(fmt::format("the console stays open at {} until Ctrl-C", console_));
  while (!stop.stop_requested() && KeepAlive().empty()) {
    session_.participant->Wait(kPeriod);
    session_.observer->Take();
  }
}

void Demo::StopAll() {
  Stop([](const Process& process) { return process.name() != kRecorderName; });
  Stop([](const Process&) { return true; });
}

void Demo::ReportPositions() {
  const bool sim_died = died_service_ == "sim";
  for (const RobotRecord& robot : episode_.robots) {
    if (!robot.state) {
      progress_.Say(fmt::format("{} never published its state", robot.name));
      continue;
    }
    progress_.Say(fmt::format("{} {} cell {}, {} of {} goals reached", robot.name,
                              sim_died             ? "was last seen in"
                              : StandsStill(robot) ? "stopped in"
                                                   : "STILL DRIVES in",
                              robot.state->cell, robot.goals_reached(), robot.goals_total()));
  }
}

void Demo::TakeLastSamples() {
  const bool robots_stop = outcome_.reason == EndReason::kProcessDied && died_service_ != "sim";
  const auto limit = clock_.Now() + (robots_stop ? kStandStillLimit : kQuietLimit);
  auto quiet_since = clock_.Now();
  while (clock_.Now() < limit && clock_.Now() - quiet_since < kQuiet) {
    session_.participant->Wait(kPeriod);
    const bool received = session_.observer->Take();
    const bool still =
        !robots_stop || std::all_of(episode_.robots.begin(), episode_.robots.end(), StandsStill);
    if (received || !still) quiet_since = clock_.Now();
  }
}

DemoResult Demo::Finish() {
  DemoResult result{outcome_, Measure(episode_)};
  const std::string title =
      fmt::format("seed {}, {}, {}", options_.seed, Name(options_.method), OutcomeLine(outcome_));
  // The result first: it needs less room than the picture.
  for (const auto& written :
       {WriteJsonFile(run_.path() / "metrics.json",
                      OutcomeJson(options_, outcome_, result.metrics)),
        WriteFile(run_.path() / "episode.svg", EpisodeSvg(episode_, title))}) {
    if (!written) result.unwritten.push_back(written.error().text);
  }
  return result;
}

}  // namespace conav::launcher
