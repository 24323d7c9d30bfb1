#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/runtime/result.h"

/// The subcommands of conav-dataset. Each adds itself to `app`; when it was chosen, it runs from
/// CLI11's callback and leaves the program's exit code in `exit_code`: 0 good, 1 failed, 2 wrong
/// use. `exit_code` outlives the parsing.
namespace conav::nhpm {

void AddSynthesizeCommand(CLI::App& app, int& exit_code);
void AddDescribeCommand(CLI::App& app, int& exit_code);
void AddImportCommand(CLI::App& app, int& exit_code);
void AddExportCommand(CLI::App& app, int& exit_code);
void AddMergeCommand(CLI::App& app, int& exit_code);
void AddSplitCommand(CLI::App& app, int& exit_code);

/// Prints `error` as every subcommand does and gives exit code 1.
int Failed(const Error& error);

/// Exit code 0, or 1 after a message when standard output is full or closed.
int WriteTextOutput(const std::string& text);

/// Writes to `file`, indented; "-" is standard output. Exit code 0, or 1 after a message.
int WriteJsonOutput(const nlohmann::ordered_json& document, const std::string& file);

}  // namespace conav::nhpm
