#include "study/live/task_command.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "common/cli/cli.h"
#include "common/runtime/file.h"
#include "common/runtime/log.h"
#include "common/runtime/text.h"
#include "common/segments/segment.h"
#include "launcher/bus_session.h"
#include "launcher/process.h"
#include "launcher/run_log.h"
#include "study/record_store.h"

namespace conav::mapping_task {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr int kMostAttempts = 1000;

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
                                 {"method", Name(MethodOf(options, number))},
                                 {"seed", seed},
                                 {"valid", IsValid(result)}};
  json.update(result.document);
  json.erase("participant");
  return json;
}

}  // namespace

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

namespace {

constexpr int kPeriodMs = 50;
constexpr int kLingerMs = 1000;
constexpr auto kGrace = 5s;
constexpr std::size_t kLogLines = 8;

void Say(const std::string& line) {
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

void WaitAMoment() { poll(nullptr, 0, kPeriodMs); }

enum class MazeEnd { kFinished, kInterrupted, kServiceDied };

/// Runs the services of one maze until the participant has finished. Throws StartupError if a
/// service cannot start or a file cannot be written.
class MazeRun {
 public:
  using Opened = std::function<void(const std::string& url)>;

  MazeRun(const fs::path& program_folder, const Maze& maze, Opened opened)
      : program_folder_(program_folder), maze_(maze), opened_(std::move(opened)) {}

  /// All services have ended on return.
  MazeEnd Run(const std::vector<PlannedService>& services, const StopToken& stop) {
    for (const PlannedService& service : services) Start(service);
    const MazeEnd end = Wait(stop);
    // Pages still fetch the result.
    const int moments = end == MazeEnd::kFinished ? kLingerMs / kPeriodMs : 0;
    for (int i = 0; i < moments && !stop.stop_requested(); ++i) WaitAMoment();
    for (const std::string& name : processes_.StopAll(kGrace)) {
      Say(name + " did not stop on request and was killed");
    }
    return end;
  }

 private:
  void Start(const PlannedService& service) {
    if (const auto written = WriteFile(maze_.config(service.name), service.config); !written) {
      throw StartupError(written.error().text);
    }
    processes_.Start(service.name,
                     {(program_folder_ / ("conav-" + service.name)).string(), "--config",
                      maze_.config(service.name).string()},
                     maze_.log(service.name));
  }

  MazeEnd Wait(const StopToken& stop) {
    for (bool open = false;; WaitAMoment()) {
      const auto url = open ? Result<std::string>() : ReadFile(maze_.url());
      if (!open && url) opened_(url->substr(0, url->find('\n')));
      open = open || url;
      if (fs::exists(maze_.result())) return MazeEnd::kFinished;
      if (ReportDeaths()) return MazeEnd::kServiceDied;
      if (stop.stop_requested()) return MazeEnd::kInterrupted;
    }
  }

  /// Whether a service died without which there is no maze.
  bool ReportDeaths() {
    bool died = false;
    for (const launcher::Process* process : processes_.TakeEnded()) {
      died = died || process->name() != kRecorder;
      Say(fmt::format("{} (pid {}) died: {}; the end of its log:", process->name(), process->pid(),
                      process->end()->Describe()));
      for (const std::string& line : launcher::LastLines(process->log(), kLogLines)) {
        Say("  | " + line);
      }
    }
    return died;
  }

  const fs::path& program_folder_;
  const Maze& maze_;
  Opened opened_;
  launcher::ProcessGroup processes_;
};

/// Finds a domain without foreign robots; it need not listen there first.
launcher::DomainLease FindDomain(const TaskOptions& options) {
  launcher::Episode episode = launcher::MakeEpisode(1, 1);
  launcher::BusSession session = launcher::JoinFreeDomain(DemoOf(options, 0), episode);
  session.observer.reset();
  return std::move(session.lease);
}

Maze MazeAt(const fs::path& folder, int number, int attempt, std::uint64_t seed) {
  return {number, attempt, seed, folder / fmt::format("maze-{}-{}", number, attempt)};
}

int PortOf(const std::string& url) { return std::stoi(url.substr(url.rfind(':') + 1)); }

/// One participant's mazes.
class TaskSession {
 public:
  /// Throws launcher::UsageError when the DDS domain is taken.
  TaskSession(const TaskOptions& options, const study::StudyFolder& folder)
      : options_(options),
        folder_(folder.path()),
        domain_(FindDomain(options)),
        port_(options.port) {}

  /// The results of earlier commands. Errors: kIo, kMalformed.
  Result<void> ReadFinished() {
    for (int number = 1; number <= options_.mazes; ++number) {
      std::optional<MazeResult> found;
      for (int attempt = 1; attempt < kMostAttempts && !found; ++attempt) {
        const Maze maze = MazeAt(folder_, number, attempt, 0);
        if (!fs::exists(maze.folder)) break;
        auto result = ReadMazeResult(maze.result());
        if (!result) return tl::unexpected(result.error());
        found = *std::move(result);
      }
      if (!found) break;
      results_.push_back(*std::move(found));
    }
    if (!results_.empty())
      Say(fmt::format("{} of {} mazes are finished", results_.size(), options_.mazes));
    return {};
  }

  /// True when all mazes are finished. Errors: kIo, kUnavailable (a service died). Throws
  /// StartupError as MazeRun does.
  Result<bool> Run(const StopToken& stop) {
    const auto count = static_cast<std::size_t>(options_.mazes);
    std::vector<std::size_t> pending;
    for (std::size_t index = results_.size(); index < count; ++index) pending.push_back(index);
    const study::PlayPiece play = [&](int, std::size_t index) -> study::StorePiece {
      auto result = Play(static_cast<int>(index) + 1, stop);
      if (result && !*result) return nullptr;
      return [this, result = std::move(result)] { return Store(result); };
    };
    return study::RunPieces(pending, count, 1, play, stop, nullptr)
        .and_then([&] { return results_.size() == count ? WriteReport() : Result<void>(); })
        .map([&] { return results_.size() == count; });
  }

 private:
  /// A folder for the next attempt.
  Result<Maze> MakeMaze(int number) const {
    const std::uint64_t seed = SeedsOf(options_).at(static_cast<std::size_t>(number) - 1);
    for (int attempt = 1; attempt < kMostAttempts; ++attempt) {
      const Maze maze = MazeAt(folder_, number, attempt, seed);
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

  /// Empty if interrupted.
  Result<std::optional<MazeResult>> Play(int number, const StopToken& stop) {
    const auto maze = MakeMaze(number);
    if (!maze) return tl::unexpected(maze.error());
    MazeSetting setting{domain_.domain(), port_, {}, folder_};
    for (const MazeResult& result : results_) setting.earlier.push_back(result.mapping_accuracy);
    MazeRun run(program_folder_, *maze, [&](const std::string& url) {
      port_ = PortOf(url);
      Say(fmt::format("maze {} of {} (method {}, seed {}): {}", number, options_.mazes,
                      Name(MethodOf(options_, number)), maze->seed, url));
    });
    const MazeEnd end = run.Run(PlanMaze(options_, *maze, setting), stop);
    if (end == MazeEnd::kFinished) return ReadMazeResult(maze->result());
    if (end == MazeEnd::kInterrupted) return std::nullopt;
    return Fail(ErrorCode::kUnavailable,
                fmt::format("maze {} was interrupted; the same command resumes there", number));
  }

  Result<bool> Store(const Result<std::optional<MazeResult>>& result) {
    if (!result) return tl::unexpected(result.error());
    results_.push_back(**result);
    Say(MazeLine(static_cast<int>(results_.size()), results_.back()));
    return WriteReport().map([] { return false; });
  }

  Result<void> WriteReport() const {
    return WriteJsonFile(folder_ / "result.json", TaskJson(options_, results_));
  }

  const TaskOptions& options_;
  const fs::path folder_;
  const fs::path program_folder_ = fs::read_symlink("/proc/self/exe").parent_path();
  launcher::DomainLease domain_;
  std::vector<MazeResult> results_;
  int port_;
};

int Run(const std::string& program, const TaskOptions& options) {
  if (const auto valid = Validate(options); !valid) return Refused(program, valid.error().text);
  if (const auto port = launcher::CheckPort("--port", options.port); !port)
    return Failed(program, port.error());
  const auto folder = study::StudyFolder::Open(fs::absolute(FolderOf(options)), DesignOf(options));
  if (!folder && folder.error().code == ErrorCode::kRefused) {
    return Refused(program, folder.error().text);
  }
  if (!folder) return Failed(program, folder.error());
  TaskSession session(options, *folder);
  Say("participant " + options.participant + "  folder " + FolderOf(options).string());
  const auto done =
      session.ReadFinished().and_then([&] { return session.Run(ProcessStopToken()); });
  if (!done) return Failed(program, done.error());
  Say(*done ? "all mazes are finished" : "interrupted; the same command resumes");
  return *done ? 0 : 1;
}

}  // namespace

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
