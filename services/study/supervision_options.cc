#include "study/supervision_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/runtime/config.h"
#include "launcher/demo_plan.h"
#include "nhpm/config.h"
#include "operator/config.h"
#include "operator/supervision/attention_queue.h"
#include "planner/config.h"
#include "sim/config.h"
#include "study/study_run.h"

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
          fmt::format("{}: {} is unknown; known values: {}", option, name, fmt::join(known, ", ")));
    }
  }
  return {};
}

Result<void> CheckRobots(const std::vector<int>& robots) {
  if (robots.empty()) return Refuse("--robots: is empty");
  for (const int count : robots) {
    if (count < 1 || count > kMostSupervised) {
      return Refuse(fmt::format("--robots: {} is not in [1, {}]", count, kMostSupervised));
    }
    if (std::ranges::count(robots, count) > 1) {
      return Refuse(fmt::format("--robots: {} is named twice", count));
    }
  }
  return {};
}

Result<void> CheckRange(const std::string& option, double value, double low, double high) {
  if (value >= low && value <= high) return {};
  return Refuse(fmt::format("{}: {} is not in [{}, {}]", option, value, low, high));
}

// Clients repeat requests by wall time, but timeouts count simulation time.
constexpr double kGuidanceValidS = 3600.0;

std::vector<std::string> Entries(const launcher::Episode& episode) {
  std::vector<std::string> entries;
  for (const auto& robot : episode.robots) entries.push_back(robot.world + "/" + robot.name);
  return entries;
}

std::vector<std::string> EntriesOf(const std::string& method, const SupervisionTrial& trial,
                                   const SupervisionOptions& options,
                                   const launcher::Episode& episode) {
  std::vector<std::string> entries;
  for (std::size_t w = 0; w < episode.worlds.size(); ++w) {
    if (MethodOf(w, trial, options) != method) continue;
    for (const auto& robot : episode.robots) {
      if (robot.world == episode.worlds[w].name) entries.push_back(robot.world + "/" + robot.name);
    }
  }
  return entries;
}

std::string OperatorYaml(const SupervisionTrial& trial, const bus::ParticipantOptions& bus,
                         const launcher::Episode& episode, const launcher::RunFolder& run) {
  operators::OperatorConfig config;
  config.bus = bus;
  config.robots = Entries(episode);
  config.database = (run.state() / "operator.db").string();
  config.attention.order = trial.order;
  return DumpConfig("operator", config);
}

std::string PersonYaml(const SupervisionTrial& trial, const SupervisionOptions& options,
                       const bus::ParticipantOptions& bus, const launcher::Episode& episode) {
  operators::SimulatedOperatorConfig config;
  config.bus = bus;
  config.robots = Entries(episode);
  config.seed = trial.seed;
  config.person.order = "queue";
  config.person.interaction = options.interaction;
  config.person.guidance_valid_s = kGuidanceValidS;
  return DumpConfig("simulated_operator", config);
}

std::string PlannerYaml(const std::string& method, std::vector<std::string> robots,
                        const SupervisionTrial& trial, const SupervisionOptions& options,
                        const bus::ParticipantOptions& bus) {
  planner::PlannerConfig config;
  config.bus = bus;
  config.name = "planner-" + method;
  config.robots = std::move(robots);
  config.method = method;
  config.seed = trial.seed;
  config.timeout_clock = "simulation";
  config.first_guidance_timeout_s = 3600.0;  // without any path a robot has nothing to follow
  config.answer_timeout_s = options.answer_timeout_s;
  return DumpConfig("planner", config);
}

}  // namespace

std::filesystem::path DefaultSupervisionOut(const std::string& fingerprint) {
  return fmt::format("runs/supervision-{:.8}", fingerprint);
}

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
  if (auto ok = CheckNames("--methods", options.methods, {"ig-mcts", "instruction"}); !ok) {
    return ok;
  }
  for (const auto& [option, value, low, high] :
       {std::tuple{"--seeds", static_cast<double>(options.seeds), 1.0, 10000.0},
        std::tuple{"--minutes", options.minutes, 0.1, 600.0},
        std::tuple{"--goals", static_cast<double>(options.goals), 1.0, 100.0},
        std::tuple{"--robots-per-world", static_cast<double>(options.robots_per_world), 1.0, 16.0},
        std::tuple{"--answer-timeout", options.answer_timeout_s, 1.0, 3600.0},
        std::tuple{"--speed", options.speed, 0.1, 1000.0},
        std::tuple{"--jobs", static_cast<double>(options.jobs), 1.0, 64.0}}) {
    if (auto ok = CheckRange(option, value, low, high); !ok) return ok;
  }
  if (!options.dds.empty()) {
    if (auto ok = CheckNames("--dds", {options.dds}, {"cyclonedds", "fastdds"}); !ok) return ok;
  }
  return CheckDomains(options.jobs);
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
          {"methods", options.methods},
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

const std::string& MethodOf(std::size_t index, const SupervisionTrial& trial,
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
  std::vector<SupervisionProcess> processes{
      {"nhpm", "conav-nhpm", DumpConfig("nhpm", nhpm)},
      {"operator", "conav-operator", OperatorYaml(trial, bus, episode, run)},
      {"simulated-operator", "conav-simulated-operator", PersonYaml(trial, options, bus, episode)}};
  for (const std::string& method : options.methods) {
    auto robots = EntriesOf(method, trial, options, episode);
    if (robots.empty()) continue;
    processes.push_back({"planner-" + method, "conav-planner",
                         PlannerYaml(method, std::move(robots), trial, options, bus)});
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
    config.camera.stream = MethodOf(w, trial, options) != "ig-mcts";
    config.speed = options.speed;
    config.publish_clock = w == 0;
    processes.push_back({"sim-" + config.world, "conav-sim", DumpConfig("sim", config)});
  }
  return processes;
}

}  // namespace conav::study
