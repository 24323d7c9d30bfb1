#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "mapping_task/task_options.h"

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

/// Where the services meet, and what went before.
struct MazeSetting {
  int domain = 0;
  int port = 0;                 // of the page
  std::vector<double> earlier;  // mapping accuracies of the mazes before
  /// Of the whole task; the segments are appended to its segments.pb.zst.
  std::filesystem::path folder;
};

/// Without it a maze goes on.
inline constexpr const char* kRecorder = "recorder";

/// A service with its whole effective configuration.
struct PlannedService {
  std::string name;
  std::string config;  // YAML document
};

/// The services of a maze in the order in which they start.
std::vector<PlannedService> PlanMaze(const TaskOptions& options, const Maze& maze,
                                     const MazeSetting& setting);

}  // namespace conav::mapping_task
