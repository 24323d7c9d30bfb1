#include "launcher/demo_plan.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "common/runtime/config.h"
#include "common/runtime/text.h"
#include "launcher/bus_session.h"
#include "nhpm/config.h"
#include "nhpm/model/load_model.h"
#include "nhpm/model/weights_file.h"
#include "operator/config.h"
#include "operator/recording/config.h"
#include "sim/config.h"
#include "sim/world/world_site.h"

namespace conav::launcher {

namespace {

/// The largest number of robots, below that of `options`, with room in the world; 0 for none.
int MostRobots(sim::WorldOptions options) {
  while (--options.robots > 0) {
    if (sim::MakeWorldSpec(options)) break;
  }
  return options.robots;
}

Result<void> CheckWorld(const DemoOptions& options, int index) {
  const sim::WorldOptions world = WorldOptionsOf(options, index);
  if (const auto site = sim::MakeSite(world); !site) {
    const std::string option = options.map.empty() ? "--preset " + world.preset + ": " : "";
    return Fail(site.error().code, option + site.error().text);
  }
  const auto spec = sim::MakeWorldSpec(world);
  if (spec) return {};
  return Fail(
      spec.error().code,
      fmt::format("--robots {}: the world of seed {} has room for {}; with {}, {}", options.robots,
                  world.seed, MostRobots(world), options.robots, spec.error().text));
}

std::filesystem::path PersonFile(const DemoOptions& options) {
  return options.person.empty() ? "" : options.person_weights / (options.person + ".nhpm");
}

Result<void> CheckOne(const DemoOptions& options, const char* option,
                      const std::filesystem::path& file) {
  if (file.empty()) return {};
  const auto model = nhpm::ReadWeightsFile(file);
  if (!model) {
    return Fail(model.error().code, fmt::format("{} {}", option, model.error().text));
  }
  const auto site = sim::MakeSite(WorldOptionsOf(options, 0));  // CheckWorlds has checked it
  if (model->rows == 0 || !site) return {};
  const OccupancyGrid& map = site->truth;
  if (model->rows == map.rows() && model->columns == map.columns()) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("{} {}: is for maps of {} x {} cells; this run's have {} x {}", option,
                          file.string(), model->rows, model->columns, map.rows(), map.columns()));
}

std::string AbsoluteText(const std::filesystem::path& file) {
  return file.empty() ? "" : std::filesystem::absolute(file).string();
}

std::optional<bus::Vendor> OtherVendor(std::optional<bus::Vendor> vendor) {
  using enum bus::Vendor;
  return vendor == kFastDds ? kCycloneDds : kFastDds;
}

/// The inputs for planning each process.
struct Setting {
  const DemoOptions& options;
  int domain;
  const Episode& episode;
  const RunFolder& run;
  std::map<std::string, std::optional<bus::Vendor>> vendors;

  /// With --dds mixed every second process of a service gets the other vendor.
  bus::ParticipantOptions Bus(const std::string& service, int number = 1) const {
    const auto vendor = vendors.at(service);
    const bool other = options.dds == "mixed" && number % 2 == 0;
    return BusOptions(options, domain, other ? OtherVendor(vendor) : vendor);
  }
  /// Resolved, so that the configuration means the same wherever it is used again.
  std::string Weights() const {
    return options.effective_model() != PerceptionModelKind::kGlpf
               ? AbsoluteText(nhpm::WeightsOrShipped(options.weights, options.effective_model()))
               : "";
  }
  std::vector<std::string> WorldsAndRobots() const {
    std::vector<std::string> entries;
    for (const RobotRecord& robot : episode.robots) {
      entries.push_back(robot.world + "/" + robot.name);
    }
    return entries;
  }
};

/// A preset, or the file of a map.
std::string MazeOf(const DemoOptions& options) {
  return options.map.empty() ? WorldOptionsOf(options, 0).preset : AbsoluteText(options.map);
}

/// The facts of a run that its recording keeps without the run folder.
std::map<std::string, std::string> Facts(const Setting& setting) {
  const DemoOptions& options = setting.options;
  return {{"run", setting.run.path().filename().string()},
          {"seed", std::to_string(options.seed)},
          {"world_seed", std::to_string(options.world_seed())},
          {"world", MazeOf(options)},
          {"rotation_deg", std::to_string(options.rotation_deg)},
          {"method", std::string(Name(options.method))},
          {"search", options.search},
          {"scenario", options.scenario},
          {"communication", options.communication},
          {"model", std::string(Name(options.effective_model()))},
          {"x_source", options.x_source},
          {"operator", options.simulated_operator},
          {"speed", fmt::format("{}", options.effective_speed())}};
}

std::string RecorderYaml(const Setting& setting) {
  recorder::RecorderConfig config;
  config.bus = setting.Bus("recorder");
  config.robots = setting.WorldsAndRobots();
  config.file = setting.run.recording().string();
  config.streams = setting.options.streams;
  config.facts = Facts(setting);
  if (setting.options.endless) {
    config.max_file_mib = 16.0;
    config.keep_files = 2;
  }
  return DumpConfig("recorder", config);
}

std::string SimYaml(const Setting& setting, std::size_t world_index) {
  const DemoOptions& options = setting.options;
  sim::SimConfig config;
  config.bus = setting.Bus("sim");
  config.world = setting.episode.worlds[world_index].name;
  config.robots.clear();
  for (const RobotRecord& robot : setting.episode.robots) {
    if (robot.world == config.world) config.robots.push_back(robot.name);
  }
  config.seed = options.world_seed() + world_index;
  config.rotation_deg = options.rotation_deg;
  config.preset = options.effective_preset();
  (options.has_height_map() ? config.map.height_map : config.map.yaml) = AbsoluteText(options.map);
  if (options.water_level) config.map.water_level = *options.water_level;
  if (options.resolution_m) config.map.resolution_m = *options.resolution_m;
  config.map.open = options.is_open() && !options.map.empty();
  if (options.robot_radius_m) config.body.radius_m = *options.robot_radius_m;
  config.map.operator_yaml = AbsoluteText(options.operator_map);
  if (options.cell_size_m) config.map.cell_size_m = *options.cell_size_m;
  config.shared_goals = options.shared_goals;
  config.keeps_goals = !options.endless;
  if (options.teleop_mps) config.drive.ScaleTo(*options.teleop_mps);
  config.camera.mode = options.camera;
  config.camera.stream = NeedsLiveView(options.method);
  config.speed = options.effective_speed();
  config.publish_clock = world_index == 0;
  config.checkpoint = (setting.run.state() / (config.world + ".checkpoint")).string();
  if (const auto scenario = ScenarioOf(options)) scenario->ApplyTo(config);
  return DumpConfig("sim", config);
}

std::string NhpmYaml(const Setting& setting, const std::string& name) {
  nhpm::NhpmConfig config;
  config.bus = setting.Bus("nhpm");
  config.name = name;
  config.model = Served(setting.options.effective_model());
  config.weights = setting.Weights();
  config.person_weights = AbsoluteText(setting.options.person_weights);
  return DumpConfig("nhpm", config);
}

/// Training of perception models finds the run's segments in its folder.
operators::SegmentOptions Recording(const Setting& setting) {
  const DemoOptions& options = setting.options;
  operators::SegmentOptions recording;
  recording.file = (setting.run.path() / "segments.pb.zst").string();
  recording.origin = "simulated";
  recording.participant = "simulated operator";
  recording.session = setting.run.path().filename().string();
  for (std::size_t w = 0; w < setting.episode.worlds.size(); ++w) {
    std::string maze = MazeOf(options);
    if (options.rotation_deg != 0) maze += fmt::format(" rotated {}", options.rotation_deg);
    recording.mazes.push_back(
        fmt::format("{}={}@{}", setting.episode.worlds[w].name, maze, options.world_seed() + w));
  }
  return recording;
}

std::string OperatorYaml(const Setting& setting) {
  operators::OperatorConfig config;
  config.bus = setting.Bus("operator");
  config.robots = setting.WorldsAndRobots();
  config.database = (setting.run.state() / "operator.db").string();
  config.recording = Recording(setting);
  config.method = setting.options.method;
  config.console.port = setting.options.console_port();
  if (setting.options.endless) config.console.pictures_mib = 2.0;
  for (const RobotRecord& robot : setting.episode.robots) {
    if (setting.options.endless) config.goals.robots.push_back(robot.name);
    if (robot.hidden_goals.empty()) continue;
    config.goals.robots.push_back(robot.name);
    config.goals.to_find = static_cast<int>(robot.hidden_goals.size());
  }
  if (config.console.on()) config.console.url_file = setting.run.console_url().string();
  config.foxglove.port = setting.options.foxglove;
  if (config.foxglove.on()) config.foxglove.url_file = setting.run.foxglove_url().string();
  config.control.start_stopped = setting.options.waits_for_operator();
  return DumpConfig("operator", config);
}

std::string SimulatedOperatorYaml(const Setting& setting) {
  operators::SimulatedOperatorConfig config;
  config.bus = setting.Bus("simulated-operator");
  config.robots = setting.WorldsAndRobots();
  if (setting.options.method == MethodKind::kTeleop) config.interaction = "teleoperation";
  config.seed = setting.options.seed;
  config.person = OperatorPerson(setting.options.simulated_operator);
  if (const auto scenario = ScenarioOf(setting.options)) scenario->ApplyTo(config.person);
  constexpr double kStepS = 0.25;    // a low-level step
  if (setting.options.teleop_mps) {  // known to the person as to the simulator
    sim::DriveConfig drive;
    drive.ScaleTo(*setting.options.teleop_mps);
    config.person.steering.forward_m = drive.forward_mps * kStepS;
    config.person.steering.backward_m = drive.backward_mps * kStepS;
    config.person.steering.turn_deg = drive.turn_deg_per_s * kStepS;
  }
  return DumpConfig("simulated_operator", config);
}

/// The waterway's search, for cells and robots of any size.
void UseOpenTerrain(const DemoOptions& options, planner::SearchConfig& search) {
  search.StartFrom("waterway");
  const sim::WorldOptions world = WorldOptionsOf(options, 0);
  const double cell_m = options.map.empty() ? world.terrain_cell_size_m : world.cell_size_m;
  planner::RegionOptions& regions = search.regions;
  if (options.is_waterway() && options.map.empty() && !options.robot_radius_m) return;
  // To the middles of occupied cells.
  regions.clearance_cells = (world.robot_radius_m + sim::kOpenMarginM) / cell_m + 0.5;
  // Regions as large as rooms, so that their number does not grow with the resolution.
  constexpr double kRegionM2 = 20.0;
  const double larger = std::max(1.0, kRegionM2 / (cell_m * cell_m) / regions.cells_per_seed);
  regions.cells_per_seed *= larger;
  regions.step_length_cells *= std::sqrt(larger);
}

std::string PlannerYaml(const Setting& setting, const std::string& name, int number) {
  planner::PlannerConfig config;
  config.bus = setting.Bus("planner", number);
  config.name = name;
  config.lease.planners = setting.options.planners;
  if (setting.options.endless) config.perception_cache_mib = 8.0;
  config.robots = setting.WorldsAndRobots();
  config.method = setting.options.method;
  config.communication.policy = setting.options.communication;
  config.seed = setting.options.seed;
  config.perception = setting.options.perception;
  config.perception_model = setting.options.effective_model();
  config.weights = setting.Weights();
  config.person = setting.options.person;
  config.x_source = setting.options.x_source;
  config.search = SearchOf(setting.options);
  if (const auto scenario = ScenarioOf(setting.options)) scenario->ApplyTo(config);
  config.search.options.report = planner::SearchDetail::kTree;
  config.decision_file = setting.run.decisions(name).string();
  if (setting.options.waits_for_operator()) {  // people need longer than the simulated operator
    const auto robots = static_cast<double>(setting.episode.robots.size());
    config.first_guidance_timeout_s = std::max(8.0, 5.0 * robots);  // paths are drawn one by one
    config.answer_timeout_s = 60.0;
    // time passes without commands, also for the queue's deadlines
    config.timeout_clock = "simulation";
  }
  return DumpConfig("planner", config);
}

}  // namespace

planner::SearchConfig SearchOf(const DemoOptions& options) {
  planner::SearchConfig search;
  if (!options.search.empty()) {
    search = planner::SearchFrom(options.search);
  } else if (options.is_open()) {
    UseOpenTerrain(options, search);
  } else if (!options.map.empty()) {
    search.StartFrom("building");
  }
  if (options.mapping_value) search.mapping_value = *options.mapping_value;
  return search;
}

operators::SyntheticOperatorParameters OperatorPerson(const std::string& kind_or_file) {
  const auto& kinds = operators::OperatorKinds();
  if (std::find(kinds.begin(), kinds.end(), kind_or_file) != kinds.end()) {
    return operators::ParametersOfKind(kind_or_file);
  }
  std::error_code ignored;
  if (!std::filesystem::exists(kind_or_file, ignored)) {
    throw StartupError(fmt::format("neither a file nor one of {}", Join(kinds, ", ")));
  }
  constexpr const char* kSection = "simulated_operator";
  operators::SimulatedOperatorConfig config;
  ReadConfig(LoadParameters(kind_or_file, kSection), kSection, config);
  return config.person;
}

Result<void> CheckOperator(const DemoOptions& options) {
  try {
    OperatorPerson(options.simulated_operator);
    return {};
  } catch (const StartupError& error) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--operator {}: {}", options.simulated_operator, error.what()));
  }
}

sim::WorldOptions WorldOptionsOf(const DemoOptions& options, int index) {
  sim::WorldOptions world;
  world.seed = options.world_seed() + static_cast<std::uint64_t>(index);
  world.preset = options.effective_preset();
  if (options.has_height_map()) {
    world.height_map.image = options.map;
    world.height_map.water_level = options.water_level.value_or(world.height_map.water_level);
    world.height_map.resolution_m = options.resolution_m.value_or(world.height_map.resolution_m);
  } else {
    world.map_yaml = options.map;
  }
  world.open = options.is_open();
  world.robot_radius_m = options.robot_radius_m.value_or(world.robot_radius_m);
  world.operator_map_yaml = options.operator_map;
  world.cell_size_m = options.cell_size_m.value_or(world.cell_size_m);
  world.robots = options.robots;
  world.shared_goals = options.shared_goals;
  world.rotation_deg = options.rotation_deg;
  if (const auto scenario = ScenarioOf(options)) scenario->ApplyTo(world);
  return world;
}

std::optional<Scenario> ScenarioOf(const DemoOptions& options) {
  if (options.scenario.empty()) return std::nullopt;
  return FindScenario(options.scenario);
}

Episode EpisodeOf(const DemoOptions& options) {
  Episode episode = MakeEpisode(options.robots, options.worlds);
  const auto scenario = ScenarioOf(options);
  if (!scenario || !scenario->marked_goals) return episode;
  auto robot = episode.robots.begin();
  for (int index = 0; index < options.worlds; ++index) {
    const auto world = sim::MakeWorldSpec(WorldOptionsOf(options, index));
    for (int i = 0; i < options.robots; ++i, ++robot) {
      if (world) robot->hidden_goals = world->goals[static_cast<std::size_t>(i)];
    }
  }
  return episode;
}

Result<void> CheckSearch(const DemoOptions& options) {
  const char* option = "--search";
  try {
    if (!options.search.empty()) planner::SearchFrom(options.search);
    option = "--scenario";
    const auto scenario = ScenarioOf(options);
    const bool searches = scenario && scenario->marked_goals;
    if (searches && options.shared_goals) {
      throw StartupError("each robot has goals of its own to find: no --shared-goals");
    }
    if (searches && NeedsLiveView(options.method)) {
      throw StartupError(
          fmt::format("nobody marks goals in the stream of --method {}", Name(options.method)));
    }
    return {};
  } catch (const StartupError& error) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{} {}: {}", option,
                            option[3] == 'c' ? options.scenario : options.search, error.what()));
  }
}

Result<void> CheckWorlds(const DemoOptions& options) {
  for (int index = 0; index < options.worlds; ++index) {
    if (auto checked = CheckWorld(options, index); !checked) return checked;
  }
  return {};
}

Result<void> CheckWeights(const DemoOptions& options) {
  return CheckOne(options, "--weights", options.weights).and_then([&] {
    return CheckOne(options, "--person-weights", PersonFile(options));
  });
}

std::string WeightsChecksum(const DemoOptions& options) {
  if (options.effective_model() == PerceptionModelKind::kGlpf) return "";
  const std::filesystem::path file = PersonFile(options);
  const auto model = nhpm::ReadWeightsFile(
      file.empty() ? nhpm::WeightsOrShipped(options.weights, options.effective_model()) : file);
  return model ? nhpm::ChecksumOf(*model) : "";
}

std::vector<PlannedProcess> PlanDemo(const DemoOptions& options, int domain, const Episode& episode,
                                     const RunFolder& run) {
  const Setting setting{options, domain, episode, run, *VendorOfService(options.dds)};
  std::vector<PlannedProcess> processes;
  if (options.recording) {
    processes.push_back({kRecorderName, "recorder", RecorderYaml(setting)});
  }
  for (std::size_t w = 0; w < episode.worlds.size(); ++w) {
    const std::string name = episode.worlds.size() == 1 ? "sim" : "sim-" + episode.worlds[w].name;
    processes.push_back({name, "sim", SimYaml(setting, w)});
  }
  for (int replica = 1; replica <= options.nhpm_processes(); ++replica) {
    const std::string name = options.nhpm_replicas == 1 ? "nhpm" : fmt::format("nhpm-{}", replica);
    processes.push_back({name, "nhpm", NhpmYaml(setting, name)});
  }
  processes.push_back({"operator", "operator", OperatorYaml(setting)});
  for (int number = 1; number <= options.planners; ++number) {
    const std::string name = options.planners == 1 ? "planner" : fmt::format("planner-{}", number);
    processes.push_back({name, "planner", PlannerYaml(setting, name, number)});
  }
  processes.push_back({"simulated-operator", "simulated-operator", SimulatedOperatorYaml(setting)});
  return processes;
}

std::vector<std::string> CommandLine(const PlannedProcess& process, const DemoOptions& options,
                                     const std::filesystem::path& program_folder,
                                     const RunFolder& run) {
  std::vector<std::string> words;
  if (const auto prefix = options.run_with.find(process.service);
      prefix != options.run_with.end()) {
    std::istringstream text(prefix->second);
    for (std::string word; text >> word;) words.push_back(word);
  }
  words.push_back((program_folder / ("conav-" + process.service)).string());
  words.push_back("--config");
  words.push_back(run.config(process.name).string());
  return words;
}

}  // namespace conav::launcher
