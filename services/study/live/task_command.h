#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/runtime/clock.h"
#include "common/runtime/result.h"
#include "common/runtime/threads.h"
#include "launcher/domain_lease.h"
#include "launcher/process.h"
#include "study/live/task_options.h"
#include "study/study_folder.h"

namespace conav::mapping_task {

/// One attempt at one maze, in a folder of its own:
///
///   maze-<number>-<attempt>/config/, logs/   of each process
///                           operator.db      the person's map and requests
///                           result.json      once they have finished
struct Maze {
  int number = 1;
  int attempt = 1;
  std::uint64_t seed = 0;
  std::filesystem::path folder;

  std::filesystem::path config(const std::string& service) const;
  std::filesystem::path log(const std::string& service) const;
  std::filesystem::path url() const { return folder / "console.url"; }
  std::filesystem::path result() const { return folder / "result.json"; }
};

/// The session's values for a maze.
struct MazeSetting {
  int domain = 0;
  int port = 0;                 // of the page
  std::vector<double> earlier;  // mapping accuracies of earlier mazes
  /// The folder of the whole task; its segments.pb.zst collects the segments.
  std::filesystem::path folder;
};

/// A maze continues when the recorder dies.
inline constexpr const char* kRecorder = "recorder";

/// A service with its complete configuration.
struct PlannedService {
  std::string name;
  std::string config;  // YAML document
};

/// The services of a maze in the order in which they start.
std::vector<PlannedService> PlanMaze(const TaskOptions& options, const Maze& maze,
                                     const MazeSetting& setting);

enum class MazeEnd { kFinished, kInterrupted, kServiceDied };

/// Runs the services of one maze until the participant has finished.
/// Threads: one.
class MazeRun {
 public:
  using Say = std::function<void(const std::string&)>;
  using Opened = std::function<void(const std::string& url)>;

  /// `program_folder` contains conav-sim and the other programs; all references outlive this
  /// object.
  MazeRun(const std::filesystem::path& program_folder, const Maze& maze, const Clock& clock,
          Say say);

  /// Starts `services` and waits. Calls `opened` with the page's address. All services have ended
  /// on return. Throws StartupError if a service cannot start or a file cannot be written.
  MazeEnd Run(const std::vector<PlannedService>& services, const Opened& opened,
              const StopToken& stop);

 private:
  void Start(const PlannedService& service);
  MazeEnd Wait(const Opened& opened, const StopToken& stop);
  /// Whether the page's address is known; calls `opened` then.
  bool ReportAddress(const Opened& opened) const;
  bool ReportDeaths();
  /// Keeps the service alive until pages have the result.
  void Linger(const StopToken& stop);

  std::filesystem::path program_folder_;
  const Maze& maze_;
  const Clock& clock_;
  Say say_;
  launcher::ProcessGroup processes_;
};

/// The result of a maze, as its operator service wrote it.
struct MazeResult {
  double mapping_accuracy = 0.0;
  nlohmann::ordered_json document;  // the whole file
};

/// Empty if the file does not exist yet. Errors: kIo; kMalformed names the file.
[[nodiscard]] Result<std::optional<MazeResult>> ReadMazeResult(const std::filesystem::path& file);

/// result.json of the task: whether it is complete, the mean mapping accuracy (the basis of a bonus
/// payment), and each finished maze, with "valid" if its mapping accuracy is above
/// kAcceptedMappingAccuracy. `results`: those of the first mazes.
nlohmann::ordered_json TaskJson(const TaskOptions& options, const std::vector<MazeResult>& results);

/// A line for the terminal.
std::string MazeLine(int number, const MazeResult& result);

/// One participant's mazes, one after the other at one address; resumes at the first unfinished
/// one. Its folder holds
///
///   study.json       participant and mazes
///   segments.pb.zst  training data for perception models, with pictures/; every segment at once
///   result.json      after each maze (TaskJson)
///   maze-<number>-<attempt>/   see Maze
///
/// An interrupted maze starts again; its earlier segments stay, as a trajectory of their own.
/// Threads: one.
class TaskSession {
 public:
  using Say = std::function<void(const std::string&)>;

  /// Errors: kRefused (the folder belongs to another participant, has other mazes or other files,
  ///         or is in use), kIo, kMalformed. Throws launcher::UsageError when the DDS domain is
  ///         taken.
  [[nodiscard]] static Result<TaskSession> Open(const TaskOptions& options,
                                                std::filesystem::path program_folder,
                                                const Clock& clock, Say say);

  /// True when all mazes are finished. Errors: kIo, kUnavailable (a service died). Throws
  /// StartupError as MazeRun does.
  [[nodiscard]] Result<bool> Run(const StopToken& stop);

 private:
  TaskSession(const TaskOptions& options, std::filesystem::path program_folder, const Clock& clock,
              Say say, study::StudyFolder folder, launcher::DomainLease domain);

  Result<void> ReadFinished();
  Result<Maze> MakeMaze(int number) const;
  /// Errors: as Run(). False if interrupted.
  Result<bool> Play(const Maze& maze, const StopToken& stop);
  void Opened(const Maze& maze, const std::string& url);
  Result<void> WriteReport() const;

  TaskOptions options_;
  std::filesystem::path program_folder_;
  const Clock& clock_;
  Say say_;
  study::StudyFolder folder_;
  launcher::DomainLease domain_;
  std::vector<MazeResult> results_;
  int port_;
};

/// Adds the options that the mapping task and the live study share.
void AddTaskOptions(CLI::App& app, TaskOptions& options);

/// Checks the options, then leads the participant through the mazes. Returns the exit code; prints
/// errors on standard error.
int RunTaskCommand(const std::string& program, const TaskOptions& options);

}  // namespace conav::mapping_task
