#include <fmt/format.h>

#include <algorithm>

#include "common/cli/cli.h"
#include "common/runtime/config.h"
#include "common/runtime/random.h"
#include "common/runtime/text.h"
#include "launcher/bus_session.h"
#include "launcher/demo_plan.h"
#include "operator/config.h"
#include "operator/recording/config.h"
#include "planner/config.h"
#include "sim/config.h"
#include "study/design.h"
#include "study/live/task_command.h"

namespace conav::mapping_task {
namespace {

constexpr std::size_t kLongestCode = 40;
constexpr int kMostMazes = 100;
constexpr std::uint64_t kSeedRange = 1'000'000'000;  // people can read these seeds out

bool IsCodeLetter(char letter) {
  return (letter >= 'A' && letter <= 'Z') || (letter >= 'a' && letter <= 'z') ||
         (letter >= '0' && letter <= '9') || letter == '_' || letter == '-';
}

std::uint64_t NumberOf(const std::string& participant) {
  return std::stoull(Sha256Hex(participant).substr(0, 16), nullptr, 16);
}

Result<void> CheckMazes(const TaskOptions& options) {
  if (auto ok = study::CheckRange("--mazes", options.mazes, 1, kMostMazes); !ok) return ok;
  const auto given = static_cast<int>(options.maze_seeds.size());
  if (given == 0 || given == options.mazes) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("--maze-seed: {} seeds for {} mazes", given, options.mazes));
}

constexpr const char* kWorld = "w1";
constexpr const char* kRobot = "r1";

struct Planning {
  const TaskOptions& options;
  const Maze& maze;
  const MazeSetting& setting;

  /// The bus options of `service`, which may have its own DDS implementation (--dds).
  bus::ParticipantOptions Bus(const std::string& service) const {
    const launcher::DemoOptions demo = DemoOf(options, maze.seed);
    return launcher::BusOptions(demo, setting.domain,
                                launcher::VendorOfService(options.dds)->at(service));
  }
  MethodKind Method() const { return MethodOf(options, maze.number); }
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
                  {"method", std::string(Name(planning.Method()))},
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
  config.camera.stream = NeedsLiveView(planning.Method());
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
  // the planner asks no model
  if (!planning.options.is_study()) config.perception_model = PerceptionModelKind::kGlpf;
  // People need more time.
  config.first_guidance_timeout_s = 8.0;
  config.answer_timeout_s = 60.0;
  config.timeout_clock = "simulation";
  return DumpConfig("planner", config);
}

}  // namespace

bool IsParticipantCode(const std::string& code) {
  return !code.empty() && code.size() <= kLongestCode && std::ranges::all_of(code, IsCodeLetter);
}

std::filesystem::path FolderOf(const TaskOptions& options) {
  if (!options.out.empty()) return options.out;
  return (options.is_study() ? "runs/study-" : "runs/mapping-") + options.participant;
}

Result<std::vector<MethodKind>> MethodsInOrder(const std::vector<MethodKind>& methods, int order,
                                               const std::string& participant) {
  const auto orders = study::WilliamsDesign(static_cast<int>(methods.size()));
  const auto rows = static_cast<int>(orders.size());
  if (auto ok = study::CheckRange("--order", order, 1, rows); order != 0 && !ok) {
    return tl::unexpected(ok.error());
  }
  const std::size_t row =
      order > 0 ? static_cast<std::size_t>(order) - 1 : NumberOf(participant) % orders.size();
  std::vector<MethodKind> ordered;
  for (const int index : orders[row]) ordered.push_back(methods[static_cast<std::size_t>(index)]);
  return ordered;
}

MethodKind MethodOf(const TaskOptions& options, int number) {
  if (!options.is_study()) return MethodKind::kMapping;
  return options.methods.at(static_cast<std::size_t>(number) - 1);
}

std::vector<std::uint64_t> SeedsOf(const TaskOptions& options) {
  if (!options.maze_seeds.empty()) return options.maze_seeds;
  const std::uint64_t own = DeriveSeed(options.seed, NumberOf(options.participant));
  std::vector<std::uint64_t> seeds;
  for (int i = 0; i < options.mazes; ++i) {
    seeds.push_back(DeriveSeed(own, static_cast<std::uint64_t>(i)) % kSeedRange);
  }
  return seeds;
}

nlohmann::ordered_json DesignOf(const TaskOptions& options) {
  nlohmann::ordered_json design{{"participant", options.participant},
                                {"preset", options.preset},
                                {"maze_seeds", SeedsOf(options)}};
  if (options.is_study()) design["methods"] = Names(options.methods);
  return design;
}

launcher::DemoOptions DemoOf(const TaskOptions& options, std::uint64_t maze_seed) {
  launcher::DemoOptions demo;
  demo.seed = maze_seed;
  demo.preset = options.preset;
  demo.camera = options.camera;
  demo.speed = options.speed;
  demo.dds = options.dds;
  demo.domain = options.domain;
  demo.console = options.port;
  demo.out = FolderOf(options);
  return demo;
}

Result<void> Validate(const TaskOptions& options) {
  if (!IsParticipantCode(options.participant)) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--participant '{}': not 1 to {} of A-Z a-z 0-9 _ -",
                            options.participant, kLongestCode));
  }
  if (auto ok = CheckMazes(options); !ok) return ok;
  if (!(options.speed > 0.0)) {
    return Fail(ErrorCode::kOutOfRange, fmt::format("--speed {}: not above 0", options.speed));
  }
  for (const std::uint64_t seed : SeedsOf(options)) {
    const launcher::DemoOptions demo = DemoOf(options, seed);
    if (auto ok = launcher::Validate(demo); !ok) return ok;
    if (auto ok = launcher::CheckWorlds(demo); !ok) return ok;
  }
  return {};
}

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

void AddTaskOptions(CLI::App& app, TaskOptions& options) {
  app.add_option("--participant", options.participant,
                 "Code of the participant, a pseudonym: 1 to 40 of A-Z a-z 0-9 _ -")
      ->required()
      ->type_name("CODE");
  app.add_option("--maze-seed", options.maze_seeds,
                 "Seeds of the mazes, one each [drawn by --seed and the participant's code]")
      ->delimiter(',')
      ->check(WholeNumber());
  app.add_option("--seed", options.seed, "Seed for drawing the maze seeds")
      ->check(WholeNumber())
      ->capture_default_str();
  app.add_option("--preset", options.preset, "Maze preset; `conav maze --help` lists them")
      ->capture_default_str();
  app.add_option("--camera", options.camera,
                 "egl renders pictures; none sends them without pixels, for tests")
      ->capture_default_str();
  app.add_option("--speed", options.speed, "Simulation time over wall time: how fast robots drive")
      ->capture_default_str();
  app.add_option("--port", options.port, "Port of the page on this machine; 0 = any free one")
      ->check(Between(0, 65535))
      ->capture_default_str();
  app.add_option("--dds", options.dds, "cyclonedds, fastdds, mixed or SERVICE=VENDOR,...");
  app.add_option("--domain", options.domain, "DDS domain [CONAV_DOMAIN or the first free one]");
  app.add_option("--out", options.out,
                 "Folder of the participant [runs/mapping-CODE, in a study runs/study-CODE]");
}

}  // namespace conav::mapping_task
