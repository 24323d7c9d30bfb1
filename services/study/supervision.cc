#include "study/supervision.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <exception>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>

#include "common/bus/subscriber.h"
#include "common/msg/convert.h"
#include "common/runtime/config.h"
#include "common/runtime/text.h"
#include "launcher/bus_session.h"
#include "launcher/demo_plan.h"
#include "launcher/process.h"
#include "nhpm/config.h"
#include "operator/config.h"
#include "operator/supervision/attention_queue.h"
#include "planner/config.h"
#include "sim/config.h"
#include "study/design.h"

namespace conav::study {
namespace {

Result<void> Refuse(std::string text) { return Fail(ErrorCode::kInvalidArgument, std::move(text)); }

Result<void> CheckNames(const std::string& option, const std::vector<std::string>& given,
                        const std::vector<std::string>& known) {
  if (given.empty()) return Refuse(option + ": is empty");
  for (const std::string& name : given) {
    if (std::ranges::count(given, name) > 1) {
      return Refuse(fmt::format("{}: {} is named twice", option, name));
    }
    if (std::ranges::find(known, name) == known.end()) {
      return Refuse(
          fmt::format("{}: {} is unknown; known values: {}", option, name, Join(known, ", ")));
    }
  }
  return {};
}

Result<void> CheckRobots(const std::vector<int>& robots) {
  if (robots.empty()) return Refuse("--robots: is empty");
  for (const int count : robots) {
    if (auto ok = CheckRange("--robots", count, 1, kMostSupervised); !ok) return ok;
    if (std::ranges::count(robots, count) > 1) {
      return Refuse(fmt::format("--robots: {} is named twice", count));
    }
  }
  return {};
}

// Clients repeat requests by wall time, but timeouts count simulation time.
constexpr double kGuidanceValidS = 3600.0;

/// The robots in worlds of `method`; without one, of all worlds.
std::vector<std::string> RobotsOf(const launcher::Episode& episode, const SupervisionTrial& trial,
                                  const SupervisionOptions& options,
                                  std::optional<MethodKind> method = std::nullopt) {
  std::vector<std::string> entries;
  for (std::size_t w = 0; w < episode.worlds.size(); ++w) {
    if (method && MethodOf(w, trial, options) != *method) continue;
    for (const auto& robot : episode.robots) {
      if (robot.world == episode.worlds[w].name) entries.push_back(robot.world + "/" + robot.name);
    }
  }
  return entries;
}

}  // namespace

Result<void> ParseInteractionTimes(const std::string& text,
                                   operators::InteractionTimeParameters& times) {
  const std::map<std::string, double*> places{{"picture", &times.picture_s},
                                              {"blocked", &times.blocked_s},
                                              {"path", &times.path_s},
                                              {"log_sd", &times.log_sd}};
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t equals = part.find('=');
    const auto place = places.find(part.substr(0, equals));
    double value = 0.0;
    const char* end = part.data() + part.size();
    const char* begin = equals == std::string::npos ? end : part.data() + equals + 1;
    const auto parsed = std::from_chars(begin, end, value);
    const bool is_time = begin != end && parsed.ec == std::errc{} && parsed.ptr == end;
    if (place == places.end() || !is_time || !(value >= 0.0 && value <= 3600.0)) {
      return Refuse(fmt::format(
          "--interaction-times: \"{}\" is not picture=S, blocked=S, path=S or log_sd=X, S in "
          "seconds up to 3600",
          part));
    }
    *place->second = value;
  }
  return {};
}

Result<void> Validate(const SupervisionOptions& options) {
  if (auto ok = CheckRobots(options.robots); !ok) return ok;
  if (auto ok = CheckNames("--orders", options.orders, operators::AttentionOrders()); !ok) {
    return ok;
  }
  struct Limit {
    const char* option;
    double value, low, high;
  };
  for (const Limit& limit :
       {Limit{"--seeds", static_cast<double>(options.seeds), 1.0, 10000.0},
        Limit{"--minutes", options.minutes, 0.1, 600.0},
        Limit{"--goals", static_cast<double>(options.goals), 1.0, 100.0},
        Limit{"--robots-per-world", static_cast<double>(options.robots_per_world), 1.0, 16.0},
        Limit{"--answer-timeout", options.answer_timeout_s, 1.0, 3600.0},
        Limit{"--speed", options.speed, 0.1, 1000.0}}) {
    if (auto ok = CheckRange(limit.option, limit.value, limit.low, limit.high); !ok) return ok;
  }
  if (!options.dds.empty()) {
    if (auto ok = CheckNames("--dds", {options.dds}, Names(bus::kVendors)); !ok) return ok;
  }
  return CheckJobs(options.jobs);
}

std::string SupervisionTrial::name() const {
  return fmt::format("n{:02}-{}-seed{}", robots, order, seed);
}

std::vector<SupervisionTrial> TrialsOf(const SupervisionOptions& options) {
  std::vector<SupervisionTrial> trials;
  for (int i = 0; i < options.seeds; ++i) {
    for (const int robots : options.robots) {
      for (const std::string& order : options.orders) {
        trials.push_back({robots, order, options.seed + static_cast<std::uint64_t>(i)});
      }
    }
  }
  return trials;
}

nlohmann::ordered_json DesignOf(const SupervisionOptions& options) {
  const operators::InteractionTimeParameters& times = options.interaction;
  return {{"study", "supervision"},
          {"methods", Names(options.methods)},
          {"interaction_times",
           {{"picture_s", times.picture_s},
            {"blocked_s", times.blocked_s},
            {"path_s", times.path_s},
            {"log_sd", times.log_sd}}},
          {"minutes", options.minutes},
          {"goals", options.goals},
          {"robots_per_world", options.robots_per_world},
          {"answer_timeout_s", options.answer_timeout_s},
          {"speed", options.speed},
          {"dds", options.dds},
          {"weights_checksum", launcher::WeightsChecksum({})}};
}

launcher::Episode EpisodeFor(const SupervisionTrial& trial, const SupervisionOptions& options) {
  const int worlds = (trial.robots + options.robots_per_world - 1) / options.robots_per_world;
  launcher::Episode episode =
      launcher::MakeEpisode(std::min(trial.robots, options.robots_per_world), worlds);
  episode.robots.resize(static_cast<std::size_t>(trial.robots));
  return episode;
}

MethodKind MethodOf(std::size_t index, const SupervisionTrial& trial,
                    const SupervisionOptions& options) {
  return options.methods[(index + trial.seed) % options.methods.size()];
}

std::vector<SupervisionProcess> PlanServices(const SupervisionTrial& trial,
                                             const SupervisionOptions& options,
                                             const bus::ParticipantOptions& bus,
                                             const launcher::Episode& episode,
                                             const launcher::RunFolder& run) {
  nhpm::NhpmConfig nhpm;
  nhpm.bus = bus;
  nhpm.weights = std::filesystem::absolute(nhpm::WeightsOrShipped("")).string();
  operators::OperatorConfig service;
  service.bus = bus;
  service.robots = RobotsOf(episode, trial, options);
  service.database = (run.state() / "operator.db").string();
  service.attention.order = trial.order;
  operators::SimulatedOperatorConfig person;
  person.bus = bus;
  person.robots = service.robots;
  person.seed = trial.seed;
  person.person.order = "queue";
  person.person.interaction = options.interaction;
  person.person.guidance_valid_s = kGuidanceValidS;
  std::vector<SupervisionProcess> processes{
      {"nhpm", "conav-nhpm", DumpConfig("nhpm", nhpm)},
      {"operator", "conav-operator", DumpConfig("operator", service)},
      {"simulated-operator", "conav-simulated-operator", DumpConfig("simulated_operator", person)}};
  for (const MethodKind method : options.methods) {
    planner::PlannerConfig planner;
    planner.bus = bus;
    planner.method = method;
    planner.name = fmt::format("planner-{}", Name(method));
    planner.robots = RobotsOf(episode, trial, options, method);
    planner.seed = trial.seed;
    planner.timeout_clock = "simulation";
    planner.first_guidance_timeout_s = 3600.0;  // without any path a robot has nothing to follow
    planner.answer_timeout_s = options.answer_timeout_s;
    if (planner.robots.empty()) continue;
    processes.push_back({planner.name, "conav-planner", DumpConfig("planner", planner)});
  }
  return processes;
}

std::vector<SupervisionProcess> PlanSimulators(const SupervisionTrial& trial,
                                               const SupervisionOptions& options,
                                               const bus::ParticipantOptions& bus,
                                               const launcher::Episode& episode) {
  std::vector<SupervisionProcess> processes;
  for (std::size_t w = 0; w < episode.worlds.size(); ++w) {
    sim::SimConfig config;
    config.bus = bus;
    config.world = episode.worlds[w].name;
    config.robots.clear();
    for (const auto& robot : episode.robots) {
      if (robot.world == config.world) config.robots.push_back(robot.name);
    }
    config.seed = 1000 * trial.seed + w;  // the same worlds for all orders
    config.goals_per_robot = options.goals;
    config.camera.mode = "none";
    config.camera.stream = MethodOf(w, trial, options) != MethodKind::kIgMcts;
    config.speed = options.speed;
    config.publish_clock = w == 0;
    processes.push_back({"sim-" + config.world, "conav-sim", DumpConfig("sim", config)});
  }
  return processes;
}

namespace {

/// Calls visit(key, field) for each stored field: one list for both directions.
template <class Record, class Visit>
void VisitFields(Record& record, Visit&& visit) {
  visit("robots", record.trial.robots);
  visit("order", record.trial.order);
  visit("seed", record.trial.seed);
  visit("failure", record.failure);
  visit("attempts", record.attempts);
  visit("minutes", record.minutes);
  visit("goals", record.goals);
  visit("wall_s", record.wall_s);
  visit("pace", record.pace);
}

template <class Workload, class Visit>
void VisitWorkload(Workload& workload, Visit&& visit) {
  visit("robots", workload.robots);
  visit("interactions", workload.interactions);
  visit("abandoned", workload.abandoned);
  visit("observed_s", workload.observed_s);
  visit("busy_s", workload.busy_s);
  visit("interaction_time_s", workload.interaction_time_s);
  visit("neglect_time_s", workload.neglect_time_s);
  visit("waiting_time_s", workload.waiting_time_s);
  visit("waiting_time_p95_s", workload.waiting_time_p95_s);
  visit("value_lost", workload.value_lost);
  visit("utilisation", workload.utilisation);
  visit("attended_robots", workload.attended_robots);
  visit("fan_out", workload.fan_out);
  visit("fan_out_with_waits", workload.fan_out_with_waits);
  visit("predicted_utilisation", workload.predicted_utilisation);
  visit("predicted_waiting_time_s", workload.predicted_waiting_time_s);
}

auto PutInto(nlohmann::ordered_json& json) {
  return [&json](const char* key, const auto& field) { json[key] = field; };
}

auto TakeFrom(const nlohmann::json& json) {
  return [&json](const char* key, auto& field) { json.at(key).get_to(field); };
}

using namespace std::chrono_literals;

constexpr auto kGrace = 5s;
constexpr auto kReadyLimit = 60s;
constexpr double kStartS = 60.0;    // limit on the wall time in which simulators start
constexpr double kSlowness = 10.0;  // how much slower than requested the worlds may run

launcher::DemoOptions SessionOptions(const SupervisionOptions& options) {
  launcher::DemoOptions demo;
  demo.dds = options.dds;
  return demo;
}

class Trial {
 public:
  Trial(const SupervisionTrial& trial, const SupervisionOptions& options,
        const std::filesystem::path& program_folder, const Clock& clock)
      : trial_(trial),
        options_(options),
        program_folder_(program_folder),
        clock_(clock),
        episode_(EpisodeFor(trial, options)),
        run_(options.out / "runs" / trial.name(), std::chrono::system_clock::now(), trial.seed),
        session_(launcher::JoinFreeDomain(SessionOptions(options), episode_)),
        queue_(*session_.participant, bus::kAttentionQueue),
        health_(*session_.participant, bus::kDiagnostics) {}

  SupervisionRecord Play(const StopToken& stop) {
    record_.trial = trial_;
    const auto bus = launcher::BusOptions(SessionOptions(options_), session_.lease.domain(),
                                          bus::ParseVendor(session_.participant->vendor()));
    const auto services = PlanServices(trial_, options_, bus, episode_, run_);
    for (const SupervisionProcess& process : services) Start(process);
    if (WaitUntilReady(services.size(), stop)) {
      for (const auto& process : PlanSimulators(trial_, options_, bus, episode_)) Start(process);
      Follow(stop);
    }
    session_.observer.reset();
    processes_.StopAll(kGrace);
    Measure();
    return record_;
  }

 private:
  void Start(const SupervisionProcess& process) {
    run_.Write(run_.config(process.name), process.config);
    processes_.Start(process.name,
                     {(program_folder_ / process.program).string(), "--config",
                      run_.config(process.name).string()},
                     run_.log(process.name));
  }

  bool SomethingDied() {
    for (const launcher::Process* process : processes_.TakeEnded()) {
      const auto last = launcher::LastLines(process->log(), 1);
      record_.failure = fmt::format("{} died: {}{}", process->name(), process->end()->Describe(),
                                    last.empty() ? "" : "; its log ends: " + last.front());
      return true;
    }
    return false;
  }

  /// Waits until each service has reported its health once.
  bool WaitUntilReady(std::size_t services, const StopToken& stop) {
    const auto deadline = clock_.Now() + kReadyLimit;
    std::set<std::string> reported;
    while (reported.size() < services) {
      if (SomethingDied()) return false;
      if (stop.stop_requested() || clock_.Now() > deadline) {
        record_.failure = stop.stop_requested() ? "interrupted"
                                                : fmt::format("{} of {} services ready after 60 s",
                                                              reported.size(), services);
        return false;
      }
      session_.participant->Wait(20ms);
      for (const auto& message : health_.Take()) {
        for (const auto& status : message.status()) reported.insert(status.name());
      }
    }
    return true;
  }

  double ElapsedSeconds(Clock::TimePoint since) const {
    return std::chrono::duration<double>(clock_.Now() - since).count();
  }

  void Follow(const StopToken& stop) {
    const auto start = clock_.Now();
    const double limit_s = kStartS + kSlowness * 60.0 * options_.minutes / options_.speed;
    while (!IsOver() && record_.failure.empty()) {
      session_.participant->Wait(20ms);
      session_.observer->Take();
      for (const auto& message : queue_.Take()) {
        if (auto queue = ToDomain(message)) newest_ = *std::move(queue);
      }
      record_.wall_s = ElapsedSeconds(start);
      if (SomethingDied()) return;
      if (stop.stop_requested()) record_.failure = "interrupted";
      if (record_.wall_s > limit_s) {
        record_.failure = fmt::format("not finished after {:.0f} s", limit_s);
      }
    }
  }

  bool IsOver() const {
    const SimTime end = SimTime::FromSeconds(60.0 * options_.minutes);
    return std::ranges::all_of(episode_.robots, [end](const launcher::RobotRecord& robot) {
      return robot.state && robot.state->stamp >= end;
    });
  }

  void Measure() {
    if (!newest_ && record_.failure.empty()) record_.failure = "no attention queue received";
    if (newest_) record_.workload = newest_->workload;
    double seconds = 0.0;
    for (const launcher::RobotRecord& robot : episode_.robots) {
      if (!robot.state) continue;
      record_.goals += static_cast<double>(robot.state->goals_reached.size());
      seconds += robot.state->stamp.ToSeconds();
    }
    seconds /= static_cast<double>(episode_.robots.size());
    record_.minutes = seconds / 60.0;
    if (record_.wall_s > 0.0) record_.pace = seconds / record_.wall_s / options_.speed;
  }

  SupervisionTrial trial_;
  const SupervisionOptions& options_;
  const std::filesystem::path& program_folder_;
  const Clock& clock_;
  launcher::Episode episode_;
  launcher::RunFolder run_;
  launcher::BusSession session_;
  bus::Subscriber<conav_msgs::msg::AttentionQueue> queue_;
  bus::Subscriber<diagnostic_msgs::msg::DiagnosticArray> health_;
  launcher::ProcessGroup processes_;
  std::optional<AttentionQueueState> newest_;
  SupervisionRecord record_;
};

}  // namespace

nlohmann::ordered_json ToJson(const SupervisionRecord& record) {
  nlohmann::ordered_json json{{"name", record.trial.name()}, {"operator", "simulated"}};
  VisitFields(record, PutInto(json));
  VisitWorkload(record.workload, PutInto(json["workload"]));
  return json;
}

Result<void> FromJson(const nlohmann::json& json, SupervisionRecord& record) {
  VisitFields(record, TakeFrom(json));
  VisitWorkload(record.workload, TakeFrom(json.at("workload")));
  return {};
}

SupervisionRecord PlayTrial(const SupervisionTrial& trial, const SupervisionOptions& options,
                            const std::filesystem::path& program_folder, const Clock& clock,
                            const StopToken& stop) {
  try {
    return Trial(trial, options, program_folder, clock).Play(stop);
  } catch (const std::exception& error) {
    SupervisionRecord record;
    record.trial = trial;
    record.failure = error.what();
    return record;
  }
}

}  // namespace conav::study
