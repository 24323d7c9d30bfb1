#pragma once

#include <CLI/CLI.hpp>

#include "common/cli/cli.h"

// One user: main; the tests parse the commands.

/// The subcommands of conav-dataset. Each adds itself to `app`; if selected, it runs from CLI11's
/// callback and leaves the program's exit code in `exit_code`: 0 good, 1 failed, 2 wrong usage.
/// `exit_code` outlives the parsing.
namespace conav::nhpm {

void AddSynthesizeCommand(CLI::App& app, int& exit_code);
void AddDescribeCommand(CLI::App& app, int& exit_code);
void AddImportCommand(CLI::App& app, int& exit_code);
void AddExportCommand(CLI::App& app, int& exit_code);
void AddMergeCommand(CLI::App& app, int& exit_code);
void AddSplitCommand(CLI::App& app, int& exit_code);

inline constexpr const char* kDatasetProgram = "conav dataset";  // in messages

/// Prints `error` as every subcommand does and gives exit code 1.
inline int Failed(const Error& error) { return Failed(kDatasetProgram, error); }

/// 0, or the exit code of Failed.
inline int ExitCode(const Result<void>& done) { return ExitCode(kDatasetProgram, done); }

}  // namespace conav::nhpm
