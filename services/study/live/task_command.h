#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/msg/method.h"
#include "common/runtime/result.h"
#include "launcher/demo_options.h"

namespace conav::mapping_task {

/// The options of `conav mapping-task` and `conav study --live`.
struct TaskOptions {
  std::string participant;  // a pseudonym
  int mazes = 3;
  /// Study: one method per maze, in this order. Empty = the mapping task.
  std::vector<MethodKind> methods;
  /// One seed per maze; empty = drawn from `seed` and the participant's code.
  std::vector<std::uint64_t> maze_seeds;
  std::uint64_t seed = 1;
  std::string preset = "conav13";
  std::string camera = "egl";
  double speed = 6.0;  // simulation time over wall time
  int port = 8080;     // of the page; 0 = any free one
  std::string dds;     // empty = the bus's default
  std::optional<int> domain;
  std::filesystem::path out;  // empty = runs/mapping-<participant>, or runs/study-<participant>

  bool is_study() const { return !methods.empty(); }
};

/// This participant's row of the Williams design of `methods`: `order` counts from 1, 0 = chosen by
/// their code. Over all orders every method is equally often at each place, and equally often after
/// each other one. Errors: kOutOfRange.
[[nodiscard]] Result<std::vector<MethodKind>> MethodsInOrder(const std::vector<MethodKind>& methods,
                                                             int order,
                                                             const std::string& participant);

/// The method of maze `number`.
MethodKind MethodOf(const TaskOptions& options, int number);

/// Whether `code` is a valid participant code: 1 to 40 of A-Z a-z 0-9 _ -.
bool IsParticipantCode(const std::string& code);

std::filesystem::path FolderOf(const TaskOptions& options);

/// A seed for each maze. Each participant gets different mazes.
std::vector<std::uint64_t> SeedsOf(const TaskOptions& options);

/// Everything that the result depends on; a resumed task must have the same.
nlohmann::ordered_json DesignOf(const TaskOptions& options);

/// The launcher's options for one of the mazes.
launcher::DemoOptions DemoOf(const TaskOptions& options, std::uint64_t maze_seed);

/// Rejects impossible options: names the option, its value and what is allowed. Generates every
/// maze once.
[[nodiscard]] Result<void> Validate(const TaskOptions& options);

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

/// Adds the options that the mapping task and the live study share.
void AddTaskOptions(CLI::App& app, TaskOptions& options);

/// Checks the options, then leads the participant through the mazes, one after the other at one
/// address; resumes at the first unfinished one. Their folder holds
///
///   study.json       participant and mazes
///   segments.pb.zst  training data for perception models, with pictures/; every segment at once
///   result.json      after each maze (TaskJson)
///   maze-<number>-<attempt>/   see Maze
///
/// An interrupted maze starts again; its earlier segments stay, as a trajectory of their own.
/// Returns the exit code; prints errors on standard error.
int RunTaskCommand(const std::string& program, const TaskOptions& options);

}  // namespace conav::mapping_task
