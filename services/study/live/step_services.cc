#include <fmt/format.h>

#include <algorithm>

#include "common/cli/cli.h"
#include "common/runtime/config.h"
#include "launcher/bus_session.h"
#include "operator/config.h"
#include "operator/recording/config.h"
#include "planner/config.h"
#include "sim/config.h"
#include "study/live/session.h"

// The configurations of a step's services, from the services' own structs.

namespace conav::live_study {
namespace {

constexpr const char* kWorld = "w1";

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

void AddSessionOptions(CLI::App& app, SessionOptions& options) {
  app.add_option("--participant", options.participant,
                 "Code of the participant, a pseudonym: 1 to 40 of A-Z a-z 0-9 _ -")
      ->required()
      ->type_name("CODE");
  app.add_option("--port", options.port, "Port of the page; 0 = any free one")
      ->check(Between(0, 65535))
      ->capture_default_str();
  app.add_option("--address", options.address,
                 "Address to listen on; other machines need TLS, and get tokens")
      ->capture_default_str();
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

}  // namespace conav::live_study
