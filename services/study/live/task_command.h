#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "study/live/task_options.h"

namespace conav::mapping_task {

/// Adds the options that the mapping task and the live study share.
void AddTaskOptions(CLI::App& app, TaskOptions& options);

/// Checks the options, then leads the participant through the mazes. Returns the exit code; prints
/// errors on standard error.
int RunTaskCommand(const std::string& program, const TaskOptions& options);

}  // namespace conav::mapping_task
