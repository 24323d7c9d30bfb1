#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <type_traits>

namespace conav::bench {

/// The options that every benchmark has. A file that cannot be written is wrong use.
void AddUsualOptions(CLI::App& app, std::string& json_file, int& rounds);

/// The ends are in it.
template <class T>
struct Limits {
  T low;
  T high;
};

/// An option for a number within limits, whose help shows the default.
template <class T>
void AddNumber(CLI::App& app, const std::string& name, T& value, const std::string& help,
               std::type_identity_t<Limits<T>> limits) {
  app.add_option(name, value, help)
      ->capture_default_str()
      ->check(CLI::Range(limits.low, limits.high));
}

/// Shows on a terminal how far it is; nothing elsewhere. `round` from 0.
void ShowRound(int round, int rounds);

/// Writes `document` unless `json_file` is empty. Throws StartupError.
void WriteFigures(const std::string& json_file, const nlohmann::ordered_json& document);

/// Parses and runs. Returns the exit code: 0; 1 with a message when `run` throws; 2 for wrong use.
/// `app` has the program's name.
int RunBenchmark(CLI::App& app, int argc, char** argv, const std::function<void()>& run);

}  // namespace conav::bench
