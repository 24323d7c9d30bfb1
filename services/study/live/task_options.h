#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "launcher/demo_options.h"

namespace conav::mapping_task {

/// What `conav mapping-task`, or `conav study --live`, was asked for.
struct TaskOptions {
  std::string participant;  // a pseudonym
  int mazes = 3;
  /// Study: of the mazes, one each, in this order. Empty = the mapping task.
  std::vector<std::string> methods;
  /// Of the mazes, one each; empty = drawn, by `seed` and the participant's code.
  std::vector<std::uint64_t> maze_seeds;
  std::uint64_t seed = 1;
  std::string preset = "conav13";
  std::string camera = "egl";
  double speed = 6.0;  // simulation time over wall time
  int port = 8080;     // of the page; 0 = any that is free
  std::string dds;     // empty = the bus's default
  std::optional<int> domain;
  std::filesystem::path out;  // empty = runs/mapping-<participant>, or runs/study-<participant>

  bool is_study() const { return !methods.empty(); }
};

/// The row of the Williams design of `methods` that is this participant's: `order` counts from 1, 0
/// = by their code. Over all orders every method is as often at each place, and as often after each
/// other one. Errors: kOutOfRange.
[[nodiscard]] Result<std::vector<std::string>> MethodsInOrder(
    const std::vector<std::string>& methods, int order, const std::string& participant);

/// Of maze `number`, as planners know it.
std::string MethodOf(const TaskOptions& options, int number);

/// Whether `code` can be a participant's: 1 to 40 of A-Z a-z 0-9 _ -.
bool IsParticipantCode(const std::string& code);

std::filesystem::path FolderOf(const TaskOptions& options);

/// A seed for each maze. Other participants get other mazes.
std::vector<std::uint64_t> SeedsOf(const TaskOptions& options);

/// All that the result depends on, to be compared when the task goes on.
nlohmann::ordered_json DesignOf(const TaskOptions& options);

/// The same as the launcher has it, for one of the mazes.
launcher::DemoOptions DemoOf(const TaskOptions& options, std::uint64_t maze_seed);

/// Refuses what cannot be: the option by name, its value, what would do. Makes every maze once.
[[nodiscard]] Result<void> Validate(const TaskOptions& options);

}  // namespace conav::mapping_task
