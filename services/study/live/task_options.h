#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "launcher/demo_options.h"

// One user: the command; options are tested without a run.

namespace conav::mapping_task {

/// The options of `conav mapping-task` and `conav study --live`.
struct TaskOptions {
  std::string participant;  // a pseudonym
  int mazes = 3;
  /// Study: one method per maze, in this order. Empty = the mapping task.
  std::vector<std::string> methods;
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
[[nodiscard]] Result<std::vector<std::string>> MethodsInOrder(
    const std::vector<std::string>& methods, int order, const std::string& participant);

/// The method of maze `number`, as planners call it.
std::string MethodOf(const TaskOptions& options, int number);

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

}  // namespace conav::mapping_task
