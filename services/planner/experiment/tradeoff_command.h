#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>

#include "planner/experiment/experiment_options.h"
#include "planner/experiment/tradeoff_sweep.h"

namespace conav::planner {

struct TradeoffArguments {
  ExperimentOptions options;
  std::filesystem::path svg;
  std::filesystem::path variants_file = ShippedVariants();
  std::string variant = "default";
  Effort effort = Effort::kSteps;
  double turn_cost = 0.0;
};

/// Adds the subcommand that RunTradeoff() carries out.
CLI::App* AddTradeoffCommand(CLI::App& app, TradeoffArguments& arguments);

/// The exit code. Throws StartupError.
int RunTradeoff(const TradeoffArguments& arguments);

}  // namespace conav::planner
