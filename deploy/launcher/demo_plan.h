#pragma once

#include <string>
#include <vector>

#include "launcher/demo_options.h"
#include "launcher/episode.h"
#include "launcher/run_folder.h"

namespace conav::launcher {

/// Starts first and ends last, and the run does not depend on it.
inline constexpr const char* kRecorderName = "recorder";

/// A process that a demo will start.
struct PlannedProcess {
  std::string name;     // of its config and log file: "sim", or "sim-w2" among several worlds
  std::string service;  // "sim": program conav-sim
  std::string config;   // YAML document
};

/// The processes of a demo in the order in which they start, each with its whole effective
/// configuration, written from the service's own config struct. Requires Validate(options) and CheckOperator(options).
std::vector<PlannedProcess> PlanDemo(const DemoOptions& options, int domain, const Episode& episode,
                                     const RunFolder& run);

/// What to execute: the --run-with words, the program beside ours, --config and the file.
std::vector<std::string> CommandLine(const PlannedProcess& process, const DemoOptions& options,
                                     const std::filesystem::path& program_folder,
                                     const RunFolder& run);

}  // namespace conav::launcher
