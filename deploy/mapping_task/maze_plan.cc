#include "mapping_task/maze_plan.h"

#include <fmt/format.h>

#include "common/runtime/config.h"
#include "launcher/bus_place.h"
#include "operator/config.h"
#include "operator/recorder/config.h"
#include "planner/config.h"
#include "sim/config.h"

namespace conav::mapping_task {
namespace {

constexpr const char* kWorld = "w1";
constexpr const char* kRobot = "r1";

struct Planning {
  const TaskOptions& options;
  const Maze& maze;
  const MazeSetting& setting;

  /// Of `service`, which may have a DDS implementation of its own (--dds).
  bus::ParticipantOptions Bus(const std::string& service) const {
    const launcher::DemoOptions demo = DemoOf(options, maze.seed);
    return launcher::BusOptions(demo, setting.domain,
                                launcher::VendorOfService(options.dds)->at(service));
  }
  std::string Method() const { return MethodOf(options, maze.number); }
  std::vector<std::string> Robots() const { return {fmt::format("{}/{}", kWorld, kRobot)}; }
};

std::string RecorderYaml(const Planning& planning) {
  const auto& [options, maze, setting] = planning;
  recorder::RecorderConfig config;
  config.bus = planning.Bus(kRecorder);
  config.robots = planning.Robots();
  config.file = (maze.folder / "recording.mcap").string();
  config.facts = {{"run", maze.folder.filename().string()},
                  {"participant", options.participant},
                  {"seed", std::to_string(maze.seed)},
                  {"world_seed", std::to_string(maze.seed)},
                  {"world", options.preset},
                  {"method", planning.Method()},
                  {"speed", fmt::format("{}", options.speed)}};
  return DumpConfig(kRecorder, config);
}

std::string SimYaml(const Planning& planning) {
  sim::SimConfig config;
  config.bus = planning.Bus("sim");
  config.world = kWorld;
  config.robots = {kRobot};
  config.seed = planning.maze.seed;
  config.preset = planning.options.preset;
  config.camera.mode = planning.options.camera;
  config.camera.stream = planning.Method() == "instruction" || planning.Method() == "teleop";
  config.speed = planning.options.speed;
  return DumpConfig("sim", config);
}

std::string OperatorYaml(const Planning& planning) {
  const auto& [options, maze, setting] = planning;
  operators::OperatorConfig config;
  config.bus = planning.Bus("operator");
  config.robots = planning.Robots();
  config.database = (maze.folder / "operator.db").string();
  config.method = planning.Method();
  config.control.start_stopped = true;
  config.console.port = setting.port;
  config.console.url_file = maze.url().string();
  config.recording.file = (setting.folder / "segments.pb.zst").string();
  config.recording.participant = options.participant;
  config.recording.session =
      fmt::format("{}-maze{}-{}", options.participant, maze.number, maze.attempt);
  config.recording.mazes = {fmt::format("{}={}@{}", kWorld, options.preset, maze.seed)};
  config.recording.pictures = true;
  config.task.kind = options.is_study() ? "study" : "mapping";
  config.task.participant = options.participant;
  config.task.number = maze.number;
  config.task.count = options.mazes;
  config.task.earlier = setting.earlier;
  config.task.result = maze.result().string();
  return DumpConfig("operator", config);
}

std::string PlannerYaml(const Planning& planning) {
  planner::PlannerConfig config;
  config.bus = planning.Bus("planner");
  config.robots = planning.Robots();
  config.method = planning.Method();
  config.seed = planning.maze.seed;
  config.perception = "embedded";
  if (!planning.options.is_study()) config.perception_model = kGlpfModel;  // nobody is asked
  // People take their time.
  config.first_guidance_timeout_s = 8.0;
  config.answer_timeout_s = 60.0;
  config.timeout_clock = "simulation";
  return DumpConfig("planner", config);
}

}  // namespace

std::filesystem::path Maze::config(const std::string& service) const {
  return folder / "config" / (service + ".yaml");
}

std::filesystem::path Maze::log(const std::string& service) const {
  return folder / "logs" / (service + ".log");
}

std::vector<PlannedService> PlanMaze(const TaskOptions& options, const Maze& maze,
                                     const MazeSetting& setting) {
  const Planning planning{options, maze, setting};
  return {{kRecorder, RecorderYaml(planning)},
          {"sim", SimYaml(planning)},
          {"operator", OperatorYaml(planning)},
          {"planner", PlannerYaml(planning)}};
}

}  // namespace conav::mapping_task
