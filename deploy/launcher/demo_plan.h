#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "launcher/demo_options.h"
#include "launcher/run_folder.h"
#include "launcher/run_log.h"
#include "launcher/scenario.h"
#include "operator/simulated/config.h"
#include "planner/config.h"
#include "sim/world/world_spec.h"

namespace conav::launcher {

/// The synthetic person of `--operator`: a kind, or the `person` of a file's section
/// `simulated_operator:`. Throws StartupError: neither a kind nor a file, or an error of the file.
operators::SyntheticOperatorParameters OperatorPerson(const std::string& kind_or_file);

/// Whether OperatorPerson(options.simulated_operator) works. Errors: kInvalidArgument with the
/// option and the reason.
[[nodiscard]] Result<void> CheckOperator(const DemoOptions& options);

/// The search of ig-mcts: that of `--search`, else the one for the kind of world, with
/// `--mapping-value`. Throws StartupError: SearchFrom().
planner::SearchConfig SearchOf(const DemoOptions& options);

/// The scenario of `--scenario`, if there is one. Throws StartupError: FindScenario().
std::optional<Scenario> ScenarioOf(const DemoOptions& options);

/// Before anything was received; with the goals that robots have to find.
Episode EpisodeOf(const DemoOptions& options);

/// Whether `--search` and `--scenario` are there, and a demo can run the scenario. Errors:
/// kInvalidArgument with the option and the reason.
[[nodiscard]] Result<void> CheckSearch(const DemoOptions& options);

/// The options from which a world's simulator builds it; `index` counts the worlds from 0.
sim::WorldOptions WorldOptionsOf(const DemoOptions& options, int index);

/// Builds every world of the run as its simulator will, to reject an impossible one before anything
/// starts. Errors: an unknown --preset, a map file's own, more --robots than a world has room for
/// (and for how many it has).
[[nodiscard]] Result<void> CheckWorlds(const DemoOptions& options);

/// Whether the weights that `options` name can be read and fit maps of the run's size, so that a
/// run does not silently use the fallback. Skips the weights that come with conav. Errors: the
/// option, the file and the reason.
[[nodiscard]] Result<void> CheckWeights(const DemoOptions& options);

/// The SHA-256 of the weights in use, as services report it: those of --person, of --weights, or
/// those that come with conav. Empty if there are none, or they cannot be read.
std::string WeightsChecksum(const DemoOptions& options);

/// Starts first and ends last; the run does not depend on it.
inline constexpr const char* kRecorderName = "recorder";

/// A process of a demo, before its start.
struct PlannedProcess {
  std::string name;     // of its config and log file: "sim", or "sim-w2" among several worlds
  std::string service;  // "sim": program conav-sim
  std::string config;   // YAML document
};

/// The processes of a demo in their start order, each with its complete configuration, written from
/// the service's own config struct. Requires Validate(options) and CheckOperator(options).
std::vector<PlannedProcess> PlanDemo(const DemoOptions& options, int domain, const Episode& episode,
                                     const RunFolder& run);

/// The command line: the --run-with words, the program next to ours, --config and the file.
std::vector<std::string> CommandLine(const PlannedProcess& process, const DemoOptions& options,
                                     const std::filesystem::path& program_folder,
                                     const RunFolder& run);

}  // namespace conav::launcher
