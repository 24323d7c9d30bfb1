#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace conav::bench {

/// The options that every benchmark has. A file that cannot be written is wrong use.
void AddUsualOptions(CLI::App& app, std::string& json_file, int& rounds);

/// Shows on a terminal how far it is; nothing elsewhere. `round` from 0.
void ShowRound(int round, int rounds);

/// Writes `document` unless `json_file` is empty. Throws StartupError.
void WriteFigures(const std::string& json_file, const nlohmann::ordered_json& document);

/// Parses and runs. Returns the exit code: 0; 1 with a message when `run` throws; 2 for wrong use.
/// `app` has the program's name.
int RunBenchmark(CLI::App& app, int argc, char** argv, const std::function<void()>& run);

}  // namespace conav::bench
