#include "study/supervision_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/runtime/config.h"
#include "launcher/demo_weights.h"
#include "nhpm/config.h"
#include "operator/config.h"
#include "planner/config.h"
#include "sim/config.h"

namespace conav::study {
namespace {

// Requests are repeated by wall time, timeouts count by simulation time.
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
  config.first_guidance_timeout_s = 3600.0;  // a robot without any path has nothing to follow
  config.answer_timeout_s = options.answer_timeout_s;
  return DumpConfig("planner", config);
}

}  // namespace

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
