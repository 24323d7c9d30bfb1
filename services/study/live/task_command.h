#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "study/live/task_options.h"

namespace conav::mapping_task {

/// What the command lines of the mapping task and of a live study have in common.
void AddTaskOptions(CLI::App& app, TaskOptions& options);

/// Checks the options, and leads the participant through the mazes. The exit code; what went wrong is
/// on standard error.
int RunTaskCommand(const std::string& program, const TaskOptions& options);

}  // namespace conav::mapping_task
