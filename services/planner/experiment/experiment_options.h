#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "planner/experiment/search_experiment.h"

namespace conav::planner {

inline constexpr const char* kProgram = "conav experiment";

/// What every experiment is asked for.
struct ExperimentOptions {
  SearchExperiment experiment;  // but for its variants
  std::string model = kDefaultPerceptionModel;
  std::filesystem::path weights;
  std::filesystem::path json;
  std::filesystem::path csv;
};

/// `operators`: the kinds that play where the user names none.
void AddExperimentOptions(CLI::App& app, const std::vector<std::string>& operators,
                          ExperimentOptions& options);

/// Plays `experiment`, with a progress line. Errors: those of RunSearchExperiment. Throws
/// StartupError when there is no such model.
[[nodiscard]] Result<std::vector<ExperimentEpisode>> PlayExperiment(
    const SearchExperiment& experiment, const ExperimentOptions& options);

}  // namespace conav::planner
