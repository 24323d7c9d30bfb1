#include "study/live/task_command.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "common/cli/cli.h"
#include "common/runtime/config.h"
#include "common/runtime/file.h"
#include "common/runtime/log.h"
#include "common/runtime/text.h"
#include "common/segments/segment.h"
#include "launcher/bus_place.h"
#include "launcher/run_log.h"
#include "operator/config.h"
#include "operator/recording/config.h"
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

  /// The bus options of `service`, which may have its own DDS implementation (--dds).
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
  // the planner asks no model
  if (!planning.options.is_study()) config.perception_model = kGlpfModel;
  // People need more time.
  config.first_guidance_timeout_s = 8.0;
  config.answer_timeout_s = 60.0;
  config.timeout_clock = "simulation";
  return DumpConfig("planner", config);
}

using namespace std::chrono_literals;

constexpr auto kPeriod = 50ms;
constexpr auto kLinger = 1s;
constexpr auto kGrace = 5s;
constexpr std::size_t kLogLines = 8;

void WaitAMoment() { poll(nullptr, 0, static_cast<int>(kPeriod.count())); }

bool IsValid(const MazeResult& result) {
  return result.mapping_accuracy > kAcceptedMappingAccuracy;
}

std::optional<MazeResult> Parse(const std::string& text) {
  MazeResult result;
  result.document = nlohmann::ordered_json::parse(text, nullptr, false);
  if (!result.document.is_object() || !result.document.contains("mapping_accuracy")) return {};
  const auto& accuracy = result.document["mapping_accuracy"];
  if (!accuracy.is_number()) return std::nullopt;
  result.mapping_accuracy = accuracy.get<double>();
  return result;
}

nlohmann::ordered_json MazeJson(const TaskOptions& options, int number, std::uint64_t seed,
                                const MazeResult& result) {
  nlohmann::ordered_json json = {{"number", number},
                                 {"method", MethodOf(options, number)},
                                 {"seed", seed},
                                 {"valid", IsValid(result)}};
  json.update(result.document);
  json.erase("participant");
  return json;
}

namespace fs = std::filesystem;

constexpr int kMostAttempts = 1000;

/// Finds a domain without foreign robots; it need not listen there first.
launcher::DomainLease FindDomain(const TaskOptions& options) {
  launcher::Episode episode = launcher::MakeEpisode(1, 1);
  launcher::BusPlace place = launcher::JoinFreeDomain(DemoOf(options, 0), episode);
  place.observer.reset();
  return std::move(place.lease);
}

Maze MazeAt(const fs::path& folder, int number, int attempt, std::uint64_t seed) {
  return {number, attempt, seed, folder / fmt::format("maze-{}-{}", number, attempt)};
}

int PortOf(const std::string& url) { return std::stoi(url.substr(url.rfind(':') + 1)); }

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

MazeRun::MazeRun(const std::filesystem::path& program_folder, const Maze& maze, const Clock& clock,
                 Say say)
    : program_folder_(program_folder), maze_(maze), clock_(clock), say_(std::move(say)) {}

MazeEnd MazeRun::Run(const std::vector<PlannedService>& services, const Opened& opened,
                     const StopToken& stop) {
  for (const PlannedService& service : services) Start(service);
  const MazeEnd end = Wait(opened, stop);
  if (end == MazeEnd::kFinished) Linger(stop);
  for (const std::string& name : processes_.StopAll(kGrace)) {
    say_(name + " did not stop on request and was killed");
  }
  return end;
}

void MazeRun::Start(const PlannedService& service) {
  if (const auto written = WriteFile(maze_.config(service.name), service.config); !written) {
    throw StartupError(written.error().text);
  }
  processes_.Start(service.name,
                   {(program_folder_ / ("conav-" + service.name)).string(), "--config",
                    maze_.config(service.name).string()},
                   maze_.log(service.name));
}

MazeEnd MazeRun::Wait(const Opened& opened, const StopToken& stop) {
  bool open = false;
  while (true) {
    open = open || ReportAddress(opened);
    if (std::filesystem::exists(maze_.result())) return MazeEnd::kFinished;
    if (ReportDeaths()) return MazeEnd::kServiceDied;
    if (stop.stop_requested()) return MazeEnd::kInterrupted;
    WaitAMoment();
  }
}

bool MazeRun::ReportAddress(const Opened& opened) const {
  const auto url = ReadFile(maze_.url());
  if (url) opened(url->substr(0, url->find('\n')));
  return url.has_value();
}

bool MazeRun::ReportDeaths() {
  bool died = false;
  for (const launcher::Process* process : processes_.TakeEnded()) {
    died = died || process->name() != kRecorder;
    say_(fmt::format("{} (pid {}) died: {}; the end of its log:", process->name(), process->pid(),
                     process->end()->Describe()));
    for (const std::string& line : launcher::LastLines(process->log(), kLogLines)) {
      say_("  | " + line);
    }
  }
  return died;
}

void MazeRun::Linger(const StopToken& stop) {
  const auto until = clock_.Now() + kLinger;
  while (clock_.Now() < until && !stop.stop_requested()) WaitAMoment();
}

Result<std::optional<MazeResult>> ReadMazeResult(const std::filesystem::path& file) {
  const auto text = ReadFile(file);
  if (!text && text.error().code == ErrorCode::kNotFound) return std::nullopt;
  if (!text) return tl::unexpected(text.error());
  auto result = Parse(*text);
  if (result) return result;
  return Fail(ErrorCode::kMalformed, file.string() + " is not the result of a maze");
}

nlohmann::ordered_json TaskJson(const TaskOptions& options,
                                const std::vector<MazeResult>& results) {
  const std::vector<std::uint64_t> seeds = SeedsOf(options);
  nlohmann::ordered_json mazes = nlohmann::ordered_json::array();
  double sum = 0.0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    mazes.push_back(MazeJson(options, static_cast<int>(i) + 1, seeds.at(i), results[i]));
    sum += results[i].mapping_accuracy;
  }
  const auto count = static_cast<double>(results.size());
  return {{"participant", options.participant},
          {"preset", options.preset},
          {"complete", results.size() == seeds.size()},
          {"mazes_wanted", seeds.size()},
          {"mazes_finished", results.size()},
          {"mazes_valid", std::ranges::count_if(results, IsValid)},
          {"mean_mapping_accuracy", results.empty() ? 0.0 : sum / count},
          {"segments", "segments.pb.zst"},
          {"mazes", std::move(mazes)}};
}

std::string MazeLine(int number, const MazeResult& result) {
  const auto number_of = [&](const char* key) { return result.document.value(key, 0); };
  return fmt::format(
      "maze {}  mapping accuracy {:.1f} %  cells right {:.1f} %  edits {}  pictures {}  {:.0f} s{}",
      number, 100.0 * result.mapping_accuracy, 100.0 * result.document.value("cell_accuracy", 0.0),
      number_of("edits"), number_of("pictures"), result.document.value("duration_s", 0.0),
      IsValid(result)
          ? ""
          : fmt::format("  (not valid: {:.0f} % or less)", 100.0 * kAcceptedMappingAccuracy));
}

TaskSession::TaskSession(const TaskOptions& options, fs::path program_folder, const Clock& clock,
                         Say say, study::StudyFolder folder, launcher::DomainLease domain)
    : options_(options),
      program_folder_(std::move(program_folder)),
      clock_(clock),
      say_(std::move(say)),
      folder_(std::move(folder)),
      domain_(std::move(domain)),
      port_(options.port) {}

Result<TaskSession> TaskSession::Open(const TaskOptions& options, fs::path program_folder,
                                      const Clock& clock, Say say) {
  auto folder = study::StudyFolder::Open(fs::absolute(FolderOf(options)), DesignOf(options));
  if (!folder) return tl::unexpected(folder.error());
  TaskSession session(options, std::move(program_folder), clock, std::move(say), *std::move(folder),
                      FindDomain(options));
  if (auto read = session.ReadFinished(); !read) return tl::unexpected(read.error());
  return session;
}

Result<void> TaskSession::ReadFinished() {
  for (int number = 1; number <= options_.mazes; ++number) {
    std::optional<MazeResult> found;
    for (int attempt = 1; attempt < kMostAttempts && !found; ++attempt) {
      const Maze maze = MazeAt(folder_.path(), number, attempt, 0);
      if (!fs::exists(maze.folder)) break;
      auto result = ReadMazeResult(maze.result());
      if (!result) return tl::unexpected(result.error());
      found = *std::move(result);
    }
    if (!found) break;
    results_.push_back(*std::move(found));
  }
  return {};
}

Result<bool> TaskSession::Run(const StopToken& stop) {
  if (!results_.empty())
    say_(fmt::format("{} of {} mazes are finished", results_.size(), options_.mazes));
  while (static_cast<int>(results_.size()) < options_.mazes) {
    const auto maze = MakeMaze(static_cast<int>(results_.size()) + 1);
    if (!maze) return tl::unexpected(maze.error());
    const auto played = Play(*maze, stop);
    if (!played || !*played) return played;
  }
  return WriteReport().map([] { return true; });
}

Result<Maze> TaskSession::MakeMaze(int number) const {
  const std::uint64_t seed = SeedsOf(options_).at(static_cast<std::size_t>(number) - 1);
  for (int attempt = 1; attempt < kMostAttempts; ++attempt) {
    const Maze maze = MazeAt(folder_.path(), number, attempt, seed);
    std::error_code error;
    if (!fs::create_directory(maze.folder, error) && !error) continue;
    for (const char* part : {"config", "logs"}) {
      if (!error) fs::create_directory(maze.folder / part, error);
    }
    if (!error) return maze;
    return Fail(ErrorCode::kIo, fmt::format("{}: cannot create this folder: {}",
                                            maze.folder.string(), error.message()));
  }
  return Fail(ErrorCode::kRefused, fmt::format("maze {} has too many attempts", number));
}

Result<bool> TaskSession::Play(const Maze& maze, const StopToken& stop) {
  MazeSetting setting{domain_.domain(), port_, {}, folder_.path()};
  for (const MazeResult& result : results_) setting.earlier.push_back(result.mapping_accuracy);
  MazeRun run(program_folder_, maze, clock_, say_);
  const MazeEnd end = run.Run(
      PlanMaze(options_, maze, setting), [&](const std::string& url) { Opened(maze, url); }, stop);
  if (end == MazeEnd::kInterrupted) return false;
  if (end == MazeEnd::kServiceDied) {
    return Fail(
        ErrorCode::kUnavailable,
        fmt::format("maze {} was interrupted; the same command resumes there", maze.number));
  }
  auto result = ReadMazeResult(maze.result());
  if (!result) return tl::unexpected(result.error());
  say_(MazeLine(maze.number, **result));
  results_.push_back(**std::move(result));
  return WriteReport().map([] { return true; });
}

void TaskSession::Opened(const Maze& maze, const std::string& url) {
  port_ = PortOf(url);
  say_(fmt::format("maze {} of {} (method {}, seed {}): {}", maze.number, options_.mazes,
                   MethodOf(options_, maze.number), maze.seed, url));
}

Result<void> TaskSession::WriteReport() const {
  return WriteJsonFile(folder_.path() / "result.json", TaskJson(options_, results_));
}

namespace {

void Say(const std::string& line) {
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

int Run(const std::string& program, const TaskOptions& options) {
  if (const auto valid = Validate(options); !valid) return Refused(program, valid.error().text);
  if (const auto port = launcher::CheckPort("--port", options.port); !port)
    return Failed(program, port.error());
  const SteadyClock clock;
  const auto program_folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  auto session = TaskSession::Open(options, program_folder, clock, Say);
  if (!session && session.error().code == ErrorCode::kRefused) {
    return Refused(program, session.error().text);
  }
  if (!session) return Failed(program, session.error());
  Say("participant " + options.participant + "  folder " + FolderOf(options).string());
  const auto done = session->Run(ProcessStopToken());
  if (!done) return Failed(program, done.error());
  Say(*done ? "all mazes are finished" : "interrupted; the same command resumes");
  return *done ? 0 : 1;
}

}  // namespace

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
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  app.add_option("--dds", options.dds, "cyclonedds, fastdds, mixed or SERVICE=VENDOR,...");
  app.add_option("--domain", options.domain, "DDS domain [CONAV_DOMAIN or the first free one]");
  app.add_option("--out", options.out,
                 "Folder of the participant [runs/mapping-CODE, in a study runs/study-CODE]");
}

int RunTaskCommand(const std::string& program, const TaskOptions& options) {
  log::SetService("mapping-task");
  log::SetMinimumLevel(log::Level::kWarning);
  InstallStopSignals();
  try {
    return Run(program, options);
  } catch (const launcher::UsageError& error) {
    return Refused(program, error.what());
  } catch (const std::exception& error) {
    return Failed(program, {ErrorCode::kUnavailable, error.what()});
  }
}

}  // namespace conav::mapping_task
