#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>

#include "planner/experiment/experiment_options.h"

namespace conav::planner {

struct TradeoffArguments {
  ExperimentOptions options;
  std::filesystem::path svg;
  std::filesystem::path variants_file = ShippedVariants();
  std::string variant = "default";
};

/// Adds the subcommand that RunTradeoff() carries out.
CLI::App* AddTradeoffCommand(CLI::App& app, TradeoffArguments& arguments);

/// The exit code. Throws StartupError.
int RunTradeoff(const TradeoffArguments& arguments);

}  // namespace conav::planner
